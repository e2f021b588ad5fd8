// Whether the server has fallen silent, counted in looks and not by the clock: while the machine or the browser keeps the
// page from running, nobody listens, and a server that nobody listened to has not been silent. Pure.

export class Silence {
  private looks = 0;

  // `most`: so many looks in a row without a word are too many.
  constructor(private readonly most: number) {}

  heard(): void {
    this.looks = 0;
  }

  // At even intervals. `waiting`: a question is open. True: the server has been silent for too long.
  look(waiting: boolean): boolean {
    this.looks = waiting ? this.looks + 1 : 0;
    return this.looks > this.most;
  }
}
