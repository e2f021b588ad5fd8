// Widgets that show values: LED, LCD, bar, gauge, label.
import { h, setText } from "../ui/dom";
import { formatOf, formatValue, inWords, share } from "../ui/numbers";
import { toneOf } from "../ui/tone";
import { bitOf } from "./controls";
import { limits, valueOf, type Context, type Widget } from "./widget";

export function led({ data, ports }: Context): Widget {
  const lamp = h("span", { class: "lamp", "aria-hidden": "true" });
  const word = h("span", { class: "led-word" });
  return {
    body: h("div", { class: "w-led" }, lamp, word),
    update() {
      const value = valueOf(ports[0]);
      const on = data.bit === undefined ? value >= (data.threshold ?? 0.5) : bitOf(value, data.bit);
      lamp.dataset["on"] = String(on);
      // A word as well, because colour alone is not enough
      setText(word, Number.isNaN(value) ? "–" : on ? "on" : "off");
    },
  };
}

export function lcd({ ports }: Context): Widget {
  const digits = h("span", { class: "lcd-digits" });
  const unit = ports[0]?.description.unit ?? "";
  const body = h("div", { class: "w-lcd" }, digits, h("span", { class: "unit" }, unit));
  return {
    body,
    update() {
      const value = valueOf(ports[0]);
      setText(digits, formatOf(ports[0]?.description, value));
      body.title = digits.textContent ?? "";
      body.dataset["tone"] = ports[0] ? toneOf(inWords(ports[0].description, value)) : "plain";
    },
  };
}

export function bar(context: Context): Widget {
  const { minimum, maximum } = limits(context);
  const port = context.ports[0];
  const fill = h("span", { class: "bar-fill" });
  const text = h("span", { class: "bar-text" });
  const zero = share(0, minimum, maximum);
  return {
    body: h("div", { class: "w-bar" }, fill, text),
    update() {
      // The bar begins at zero if zero is in the range, so that the sign is visible.
      const at = share(valueOf(port), minimum, maximum);
      fill.style.left = `${100 * Math.min(zero, at)}%`;
      fill.style.width = `${100 * Math.abs(at - zero)}%`;
      setText(text, `${formatOf(port?.description, valueOf(port))} ${port?.description.unit ?? ""}`);
    },
  };
}

const kSweep = 240; // degrees

export function gauge(context: Context): Widget {
  const { minimum, maximum } = limits(context);
  const port = context.ports[0];
  const text = h("span", { class: "gauge-text" });
  const needle = h("span", { class: "needle" });
  const ends = h("span", { class: "gauge-ends" }, h("span", {}, formatValue(minimum)), h("span", {}, formatValue(maximum)));
  return {
    body: h("div", { class: "w-gauge" }, h("span", { class: "dial" }, needle), text, ends),
    update() {
      const angle = -kSweep / 2 + kSweep * share(valueOf(port), minimum, maximum);
      needle.style.transform = `rotate(${angle.toFixed(2)}deg)`;
      setText(text, `${formatOf(port?.description, valueOf(port))} ${port?.description.unit ?? ""}`);
    },
  };
}

export function label({ data }: Context): Widget {
  return { body: h("div", { class: "w-label" }, data.label), update: () => undefined };
}
