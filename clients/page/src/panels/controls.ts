// Widgets that write values: slider with jog buttons, number, push button, radio buttons, bit selector.
import { h, setText } from "../ui/dom";
import { whileHeld } from "../ui/hold";
import { fieldText, formatEnd, formatOf, niceStep, share } from "../ui/numbers";
import { commandedOf, limits, valueOf, writeAll, type Context, type Widget } from "./widget";

const kTouchedMs = 600; // for this long after a touch, the value in force does not move a control

// Shows the limits, the value that is commanded (the thumb), and the actual value (the triangle), both as
// numbers, too.
export function slider(context: Context): Widget {
  const { data, ports, actual } = context;
  const { minimum, maximum } = limits(context);
  const description = ports[0]?.description;
  const text = (value: number) => formatOf(description && { ...description, minimum, maximum }, value);
  const input = h("input", { type: "range", min: minimum, max: maximum, step: "any", "aria-label": data.label });
  const marker = h("span", { class: "actual", hidden: !actual });
  const wanted = h("output", { class: "slider-value", title: "Commanded" });
  const is = h("output", { class: "slider-actual", title: "Actual", hidden: !actual });
  let touched = 0;
  const set = (value: number) => {
    touched = performance.now();
    const within = Math.min(maximum, Math.max(minimum, value));
    input.value = String(within);
    writeAll(ports, within);
  };
  input.addEventListener("input", () => set(Number(input.value)));
  const jog = (sign: number) => {
    const button = h("button", { type: "button", class: "small jog", "aria-label": `${data.label} ${sign < 0 ? "less" : "more"}` }, sign < 0 ? "−" : "+");
    whileHeld(button, () => set(commandedOf(ports[0]) + sign * (data.jog ?? 0)));
    return button;
  };
  const buttons = data.jog ? [jog(-1), jog(1)] : [];
  const ends = h("span", { class: "slider-ends" }, h("span", {}, formatEnd(minimum)), h("span", {}, `${formatEnd(maximum)} ${description?.unit ?? ""}`));
  return {
    body: h("div", { class: "w-slider" }, buttons[0], h("span", { class: "track" }, input, marker, ends), buttons[1], h("span", { class: "slider-values" }, wanted, is)),
    update() {
      const value = valueOf(ports[0]);
      if (performance.now() - touched > kTouchedMs && !Number.isNaN(value) && Number(input.value) !== value) input.value = String(value);
      setText(wanted, text(value));
      if (!actual) return;
      setText(is, text(valueOf(actual)));
      marker.style.setProperty("--at", share(valueOf(actual), minimum, maximum).toFixed(4));
    },
    setEnabled: (on) => [input, ...buttons].forEach((control) => (control.disabled = !on)),
  };
}

export function number(context: Context): Widget {
  const { data, ports } = context;
  const { minimum, maximum } = limits(context);
  const unit = ports[0]?.description.unit ?? "";
  const input = h("input", { type: "number", min: minimum, max: maximum, step: niceStep(minimum, maximum), "aria-label": `${data.label} in ${unit || "units"}` });
  input.addEventListener("change", () => Number.isFinite(input.valueAsNumber) && writeAll(ports, input.valueAsNumber));
  return {
    body: h("div", { class: "w-number" }, input, h("span", { class: "unit" }, unit)),
    update() {
      const value = valueOf(ports[0]);
      if (document.activeElement !== input && !Number.isNaN(value)) input.value = fieldText(value, minimum, maximum);
    },
    setEnabled: (on) => (input.disabled = !on),
  };
}

// Counts up at each press, or writes one value while pressed and another when let go.
export function button({ data, ports }: Context): Widget {
  const element = h("button", { type: "button", class: "w-button" }, data.label || "Press");
  if (data.mode === "value") {
    const release = () => data.release !== undefined && element.dataset["down"] && (delete element.dataset["down"], writeAll(ports, data.release));
    const press = () => ((element.dataset["down"] = "1"), writeAll(ports, data.value ?? 1));
    element.addEventListener("pointerdown", press);
    for (const end of ["pointerup", "pointercancel", "pointerleave", "blur"]) element.addEventListener(end, release);
    element.addEventListener("keydown", (event) => [" ", "Enter"].includes(event.key) && !event.repeat && press());
    element.addEventListener("keyup", release);
  } else {
    element.addEventListener("click", () => ports.forEach((port) => writeAll([port], commandedOf(port) + 1)));
  }
  return { body: element, update: () => undefined, setEnabled: (on) => (element.disabled = !on) };
}

export function radio({ data, ports }: Context): Widget {
  const group = `radio-${Math.random().toString(36).slice(2)}`;
  const inputs = (data.choices ?? [{ label: "Off", value: 0 }, { label: "On", value: 1 }]).map(({ label, value }) => {
    const input = h("input", { type: "radio", name: group, value });
    input.addEventListener("change", () => writeAll(ports, value));
    return { input, label: h("label", {}, input, h("span", {}, label)), value };
  });
  return {
    body: h("div", { class: "w-radio", role: "radiogroup", "aria-label": data.label }, ...inputs.map(({ label }) => label)),
    update: () => inputs.forEach(({ input, value }) => (input.checked = valueOf(ports[0]) === value)),
    setEnabled: (on) => inputs.forEach(({ input }) => (input.disabled = !on)),
  };
}

export function bits({ data, ports }: Context): Widget {
  const names = data.bits ?? Array.from({ length: 8 }, (_, i) => `Bit ${i}`);
  const canWrite = ports[0]?.side === "input";
  const boxes = names.map((name, i) => {
    const box = h("input", { type: "checkbox" });
    box.addEventListener("change", () => {
      const before = commandedOf(ports[0]);
      const without = before - (bitOf(before, i) ? 2 ** i : 0);
      writeAll(ports, without + (box.checked ? 2 ** i : 0));
    });
    return { box, label: h("label", {}, box, h("span", {}, name)) };
  });
  return {
    body: h("div", { class: "w-bits", role: "group", "aria-label": data.label }, ...boxes.map(({ label }) => label)),
    update: () => boxes.forEach(({ box }, i) => (box.checked = bitOf(commandedOf(ports[0]), i))),
    setEnabled: (on) => boxes.forEach(({ box }) => (box.disabled = !on || !canWrite)),
  };
}

// Bits of numbers up to 2^53. JavaScript's own operators end at 2^31.
export function bitOf(value: number, bit: number): boolean {
  return Math.floor(value / 2 ** bit) % 2 === 1;
}
