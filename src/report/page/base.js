"use strict";
// The namespace that all scripts of the page share, with what each of them needs: events, numbers as text, elements.

const page = {
  data: null, // the parsed JSON
  front: null, // decoded columns, see decode.js
  timings: {}, // ms from the start of navigation
  // Is a front of more designs, or of what is changed in the study, still to come? Only of a live study.
  awaits: () => false,
  // selection: brushes changed; columns: axes chosen, moved or reversed; current: the point under the pointer
  // front: another front in place of the one before; changes: what is changed in the study
  // choice: weights and wishes; others: other results over this one
  events: d3.dispatch("selection", "columns", "colour", "current", "card", "theme", "layout", "front", "changes", "pins", "choice", "others"),
};

// Four significant digits and all those before the point; thousands apart from 10 000 on. Every digit is where the pointer rests, on cards
// and in the CSV.
page.short = (value) => {
  if (typeof value === "string") return value;
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e9)) return page.powerText(value);
  const text = size >= 1000 ? String(Math.round(size)) : String(Number(size.toPrecision(4)));
  return (value < 0 ? "−" : "") + (size >= 1000 ? page.count(text) : text);
};

// Very small and very large numbers, with a power of ten.
page.powerText = (value, digits = 4) => Number(value.toPrecision(digits)).toExponential().replace(/^-/, "−").replace("e+", "e").replace("e-", "e−");

// A number that stands for itself on an axis: eight significant digits, or those that it has.
page.exactly = (value) => {
  if (typeof value !== "number" || !Number.isFinite(value) || page.short(value).includes("e")) return page.short(value);
  const [whole, part] = String(Math.abs(Number(value.toPrecision(8)))).split(".");
  return `${value < 0 ? "−" : ""}${page.count(whole)}${part ? `.${part}` : ""}`;
};

// Units as people write them.
page.unit = (unit) => ({ Nm: "N m", deg: "°" })[unit] ?? (unit ?? "").replace(/^um\b/, "µm").replace(/\b([kcdm]?m)([23])\b/g, (_, length, power) => length + { 2: "²", 3: "³" }[power]);

// Numbers in a text of the program, grouped as all others are; those of designs stay whole.
page.grouped = (text) => text.replace(/(?<![\w.-]|design )\d{5,}(?![\w-])/g, (digits) => page.count(digits));

// The shortest text that reads back as the same number, in f32 for columns that are stored so.
page.full = (value, type) => {
  if (typeof value === "string") return value;
  if (value === null || value === undefined || Number.isNaN(value)) return "";
  if (type === "f32") {
    for (let digits = 1; digits < 9; digits++) {
      const text = value.toPrecision(digits);
      if (Math.fround(Number(text)) === value) return String(Number(text));
    }
    return String(Number(value.toPrecision(9)));
  }
  return String(value);
};

// Groups of three from 10 000 on.
page.count = (n) => {
  const text = String(n);
  return text.length < 5 ? text : text.replace(/\B(?=(\d{3})+$)/g, "\u202f");
};

page.percent = (part, of) => {
  if (!of) return "–";
  const share = (100 * part) / of;
  if (part < of && share >= 99.95) return "> 99.9 %";
  if (part > 0 && share < 0.01) return "< 0.01 %";
  return `${share.toFixed(share >= 10 || share === 0 ? 1 : 2)} %`;
};

page.seconds = (s) => {
  if (s < 1) return `${Number((s * 1000).toPrecision(3))} ms`;
  if (s < 120) return `${Number(s.toPrecision(3))} s`;
  return s < 7200 ? `${Number((s / 60).toPrecision(3))} min` : `${Number((s / 3600).toPrecision(3))} h`;
};

// A name in words, without the unit at its end; and as the axes of the pictures have it, with the unit in brackets.
page.axisWords = (name, unit) => {
  const suffix = `_${(unit ?? "").replace("/", "_per_").replace("µ", "u").replace(/[ ·]/g, "")}`;
  const stem = unit && name.endsWith(suffix) && name.length > suffix.length ? name.slice(0, -suffix.length) : name;
  // The point of a quantile: `draw_q99_9`.
  return stem.replace(/(^|_)(q\d+)_(\d+)(?=_|$)/, "$1$2.$3").replace(/_/g, " ");
};
page.axisName = (name, unit) => page.axisWords(name, unit) + (unit ? ` [${page.unit(unit)}]` : "");

page.withUnit = (name, unit) => (unit ? `${name} [${page.unit(unit)}]` : name);

// Attributes with null are left out; functions become listeners; strings become text, never markup.
page.element = (tag, attributes, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes || {})) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === "function") element.addEventListener(name, value);
    else element.setAttribute(name, value === true ? "" : value);
  }
  element.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return element;
};

page.byId = (id) => document.getElementById(id);

// Long names may break after an underscore.
page.breakable = (name) => name.split(/(?<=_)/).flatMap((part) => [part, document.createElement("wbr")]).slice(0, -1);

// Work that is requested by many events is done once, before the next frame.
{
  const waiting = new Map();
  page.schedule = (name, work) => {
    if (waiting.has(name)) return;
    waiting.set(
      name,
      requestAnimationFrame(() => {
        waiting.delete(name);
        work();
      }),
    );
  };
}

// Work that waits until it has not been asked for during `pause` ms, and until the exact answer is there if one is awaited: on a machine with
// few cores it would only delay that. Nothing waits for an answer longer than a second after it was last asked for.
page.afterPause = (pause, work) => {
  let waiting = 0;
  let since = null;
  const look = () => {
    const isAwaited = page.isAnswered && !page.isAnswered() && performance.now() - since < 1000;
    if (isAwaited) return void (waiting = setTimeout(look, pause));
    since = null;
    return work();
  };
  return () => {
    clearTimeout(waiting);
    since = performance.now();
    waiting = setTimeout(look, pause);
  };
};

// Draws a part of the page anew. Who had the focus in it has it afterwards: on the same control, by what `data-focus` or its id calls it,
// on another of the same thing (`data-focus` is an action and a thing), or on the one that has come to its place; without any, on
// `otherwise`.
page.keepFocus = (box, draw, otherwise = null) => {
  const focused = box.contains(document.activeElement) && document.activeElement !== box ? document.activeElement : null;
  const stops = () => [...box.querySelectorAll("a[href], button, input, select, summary, [tabindex]")].filter((it) => !it.disabled && it.getClientRects().length);
  const nameOf = (it) => it.dataset.focus || it.id || (it.dataset.x ? `${it.dataset.x} ${it.dataset.y}` : null);
  const at = focused ? stops().indexOf(focused) : -1;
  const result = draw();
  if (!focused || (document.activeElement === focused && !focused.disabled)) return result;
  const now = stops();
  const name = nameOf(focused);
  const thing = focused.dataset.focus?.replace(/^\S+/, "");
  const next = (name && now.find((it) => nameOf(it) === name)) || (thing && now.find((it) => it.dataset.focus?.endsWith(thing))) || now[Math.max(0, Math.min(at, now.length - 1))] || document.querySelector(otherwise);
  next?.focus({ preventScroll: true });
  return result;
};

// The same where details may be open: they stay so.
page.keepOpen = (box, draw) => {
  const open = [...box.querySelectorAll("details")].map((it) => it.open);
  page.keepFocus(box, draw);
  box.querySelectorAll("details").forEach((it, at) => (it.open = open[at] ?? it.open));
};

// Buttons of which one is a stop for the tab key; the left and the right arrow go on from there, or the upper and the lower one where they
// stand below each other. The buttons above the lines of a table are reached from these with the upper arrow: `below` is the first line, if
// there is any, which is the stop then.
page.oneStop = (box, selector, { below = null, isColumn = false } = {}) => {
  const [forth, back] = isColumn ? ["ArrowDown", "ArrowUp"] : ["ArrowRight", "ArrowLeft"];
  const buttons = [...box.querySelectorAll(selector)].filter((it) => !it.disabled);
  const stopAt = (button) => buttons.forEach((it) => it.setAttribute("tabindex", it === button && !below ? 0 : -1));
  buttons.forEach((button, at) => {
    button.addEventListener("focus", () => stopAt(button));
    button.addEventListener("keydown", (event) => {
      const next = { [forth]: buttons[at + 1], [back]: buttons[at - 1], Home: buttons[0], End: buttons[buttons.length - 1], ...(below ? { ArrowDown: below } : {}) };
      if (!(event.key in next)) return;
      next[event.key]?.focus();
      event.preventDefault();
      event.stopPropagation();
    });
  });
  stopAt(buttons[0]);
};

// Said aloud, by those who hear the page.
page.say = (text) => (page.byId("said").textContent = text);

// A label may be empty.
page.wordText = (word) => (word === "" ? "(empty)" : word);

page.tip = (event, text) => {
  const tip = page.byId("tip");
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  const room = document.documentElement.clientWidth - tip.offsetWidth - 8;
  tip.style.left = `${Math.max(4, Math.min(event.clientX + 14, room))}px`;
  tip.style.top = `${Math.max(4, Math.min(event.clientY + 16, window.innerHeight - tip.offsetHeight - 8))}px`;
};

page.download = (name, type, text) => {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const link = page.element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
};

page.variable = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// A colour as the 32-bit number of one pixel of an ImageData (little-endian: alpha first).
page.pixel = (colour) => {
  const { r, g, b } = d3.rgb(colour);
  return (0xff000000 | (Math.round(b) << 16) | (Math.round(g) << 8) | Math.round(r)) >>> 0;
};
