// The colour of every point, by the chosen column, and its colour bar.
{
  const STEPS = 256;
  // Plasma without the end that is hard to see on the background: marks have a contrast of 3 at least.
  const rampOf = () => (page.dark() ? (t) => d3.interpolatePlasma(0.42 + 0.58 * t) : (t) => d3.interpolatePlasma(0.61 * t));
  // Areas have another scale, of the same contrast.
  page.areaRamp = () => (page.dark() ? (t) => d3.interpolateViridis(0.37 + 0.63 * t) : (t) => d3.interpolateViridis(0.57 * t));

  page.ramp = rampOf;
  page.rampPixels = (ramp) => Uint32Array.from(stopsOf(ramp, STEPS), page.pixel);

  // Words have colours that can be told apart, of which each has a contrast of 4.5 on the background.
  const WORDS = {
    light: ["#0072b2", "#c44601", "#00795c", "#9c4a8a", "#8a6d00", "#3a3a3a", "#5b3fd6", "#c0003a"],
    dark: ["#56b4e9", "#e69f00", "#2fcb9f", "#e08fc4", "#f0e442", "#d0d0d0", "#a99bff", "#ff7a90"],
  };
  page.isCategory = (column) => Boolean(column.words) && column.words.length <= WORDS.light.length;
  const wordColours = (column) => (page.isCategory(column) ? WORDS[page.dark() ? "dark" : "light"] : null);

  const placeOf = (column) => {
    const count = column.words ? column.words.length - 1 : 0;
    if (column.words) return (value) => (count > 0 ? value / count : 0.5);
    const span = column.high - column.low;
    return (value) => (span > 0 ? (value - column.low) / span : 0.5);
  };

  // The palette, whose last colour is that of absent values, and the place in it of each row's colour; computed again when the column or
  // the theme changes.
  let cache = { key: null };
  page.paints = () => {
    const { front, state } = page;
    const key = `${state.colour} ${page.dark()}`;
    if (cache.key === key && cache.front === front) return cache;
    const column = front.byName.get(state.colour);
    const words = column && wordColours(column);
    const palette = [...(column ? words ?? stopsOf(rampOf(), STEPS) : []), page.variable("--muted")];
    const none = palette.length - 1;
    const index = new Uint16Array(front.rows).fill(none);
    const place = column && placeOf(column);
    for (let i = 0; column && i < index.length; i++) {
      const value = column.values[i];
      const t = words ? 0 : place(value);
      if (words && value < none) index[i] = value;
      else if (!words && t >= 0) index[i] = Math.min(STEPS - 1, Math.round(t * (STEPS - 1)));
    }
    const pixels = palette.map(page.pixel);
    cache = { key, front, palette, index, pixels: Uint32Array.from(index, (at) => pixels[at]) };
    return cache;
  };

  page.colours = () => page.paints().pixels;

  const stopsOf = (ramp, count = 11) => d3.range(count).map((i) => ramp(i / (count - 1)));

  // A horizontal bar with its ticks: an SVG axis below a strip of CSS gradient.
  page.colourBar = (title, low, high, ramp, width) => {
    const bar = page.element("div", { class: "colour-bar", role: "img", "aria-label": `Colour: ${title}` });
    const strip = page.element("div", { class: "strip" });
    const stops = stopsOf(ramp);
    strip.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    strip.dataset.bands = JSON.stringify([stops]);
    strip.style.width = `${width}px`;
    bar.append(page.element("div", { class: "bar-title" }, title), strip);
    if (Number.isFinite(low) && high > low) {
      const scale = d3.scaleLinear([low, high], [0, width]);
      const svg = d3.create("svg").attr("width", width).attr("height", 20).attr("aria-hidden", "true");
      // Numbers at the ends stay within the bar: cut off, they would look like other numbers.
      const anchor = (value) => (scale(value) < 26 ? "start" : scale(value) > width - 26 ? "end" : "middle");
      const format = page.tick(scale, 4);
      // As many numbers as have room beside each other.
      let taken = -Infinity;
      const room = scale.ticks(4).filter((value) => {
        const length = 6.6 * format(value).length;
        const left = scale(value) - { start: 0, middle: length / 2, end: length }[anchor(value)];
        if (left < taken + 7) return false;
        taken = left + length;
        return true;
      });
      svg.append("g").attr("class", "tick-axis").call(d3.axisBottom(scale).tickValues(room).tickSizeOuter(0).tickSize(4).tickFormat(format));
      svg.selectAll(".tick text").attr("text-anchor", anchor);
      bar.append(svg.node());
    } else bar.append(page.element("div", { class: "bar-title" }, Number.isFinite(low) ? `always ${page.short(low)}` : "no values"));
    return bar;
  };

  // "20 k" for a large number would hide digits: use d3's own format with a space for thousands.
  page.tick = (scale, count) => {
    const format = scale.tickFormat(count);
    const [a, b] = scale.domain();
    const size = Math.max(Math.abs(a), Math.abs(b));
    if (size >= 1e7 || (size < 1e-3 && size > 0)) {
      // As many digits as tell one tick from the next.
      const digits = Math.max(1, Math.min(15, Math.ceil(Math.log10(size / d3.tickStep(a, b, count))) + 1));
      return (value) => (value === 0 ? "0" : page.powerText(value, digits));
    }
    return (value) => {
      const text = format(value).replace(/,/g, "");
      const whole = text.match(/\d+/)?.[0] ?? "";
      return text.replace(whole, page.count(whole));
    };
  };

  const BAR = 240; // px
  const legendOf = (column, room) => {
    const title = page.axisName(column.name, column.unit);
    const ramp = rampOf();
    if (!column.words) return page.colourBar(title, column.low, column.high, ramp, Math.min(BAR, room));
    const place = placeOf(column);
    const swatch = (word, i) => {
      const square = page.element("span", { class: "swatch" });
      square.style.background = wordColours(column)?.[i] ?? ramp(place(i));
      return page.element("span", { class: "word" }, square, page.wordText(word));
    };
    return page.element("div", { class: "colour-bar" }, page.element("div", { class: "bar-title" }, title), page.element("div", { class: "words" }, column.words.map(swatch)));
  };

  // At most so many px wide.
  page.legend = (room) => {
    const column = page.front.byName.get(page.state.colour);
    const bar = column ? legendOf(column, room) : page.element("div", {});
    if (page.isCrowdOfPoints()) page.crowdKey(bar);
    return bar;
  };
}
