// A button that acts when it is pressed, and again and again while it is held.

const kFirstMs = 400;
const kAgainMs = 100;

export function whileHeld(button: HTMLButtonElement, act: () => void): void {
  let timer = 0;
  const again = (afterMs: number) => {
    timer = window.setTimeout(() => {
      if (button.disabled) return;
      act();
      again(kAgainMs);
    }, afterMs);
  };
  const end = () => clearTimeout(timer);
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    end();
    act();
    again(kFirstMs);
  });
  for (const name of ["pointerup", "pointercancel", "pointerleave", "blur"]) button.addEventListener(name, end);
  // A key, which the browser repeats by itself, or a reader of the page
  button.addEventListener("click", (event) => !(event.detail > 0) && act());
}
