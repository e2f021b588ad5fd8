// Decides whether the server has fallen silent. It counts looks, not time: while the machine or the browser
// keeps the page from running, the page does not listen, and the server has not been silent. Pure.

export class Silence {
  private looks = 0;

  // `most`: more looks in a row without a message are too many.
  constructor(private readonly most: number) {}

  heard(): void {
    this.looks = 0;
  }

  // Call it at even intervals. `waiting`: a question is open. Returns true if the server has been silent for
  // too long.
  look(waiting: boolean): boolean {
    this.looks = waiting ? this.looks + 1 : 0;
    return this.looks > this.most;
  }
}
