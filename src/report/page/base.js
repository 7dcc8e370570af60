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
  if (size !== 0 && (size < 1e-4 || size >= 1e9)) return String(Number(value.toPrecision(4))).replace(/^-/, "−").replace("e-", "e−");
  const text = size >= 1000 ? String(Math.round(size)) : String(Number(size.toPrecision(4)));
  return (value < 0 ? "−" : "") + (size >= 1000 ? page.count(text) : text);
};

// Units as people write them.
page.unit = (unit) => ({ Nm: "N m", deg: "°" })[unit] ?? (unit ?? "").replace(/^um\b/, "µm").replace(/(?<=m)[23](?!\w)/g, (power) => ({ 2: "²", 3: "³" })[power]);

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

// A name as the axes of the pictures have it: words, and the unit in brackets in place of the last ones.
page.axisName = (name, unit) => {
  const suffix = `_${(unit ?? "").replace("/", "_per_").replace("µ", "u").replace(/[ ·]/g, "")}`;
  const stem = unit && name.endsWith(suffix) && name.length > suffix.length ? name.slice(0, -suffix.length) : name;
  return stem.replace(/_/g, " ") + (unit ? ` [${page.unit(unit)}]` : "");
};

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
