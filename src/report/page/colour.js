// The colour of every point, by the chosen column, and its colour bar.
{
  const STEPS = 256;
  // Plasma without the end that is hard to see on the background: marks have a contrast of 3 at least.
  const rampOf = () => (page.dark() ? (t) => d3.interpolatePlasma(0.42 + 0.58 * t) : (t) => d3.interpolatePlasma(0.61 * t));
  // Areas need no such contrast: they have more of the scale.
  page.areaRamp = () => (page.dark() ? (t) => d3.interpolateViridis(0.22 + 0.78 * t) : (t) => d3.interpolateViridis(0.9 * t));

  page.ramp = rampOf;
  page.rampPixels = (ramp) => Uint32Array.from({ length: STEPS }, (_, i) => page.pixel(ramp(i / (STEPS - 1))));

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

  // Pixel colours of all rows, computed again when the column or the theme changes.
  let cache = { key: null, pixels: null, front: null };
  page.colours = () => {
    const { front, state } = page;
    const key = `${state.colour} ${page.dark()}`;
    if (cache.key === key && cache.front === front) return cache.pixels;
    const none = page.pixel(page.variable("--muted"));
    const pixels = new Uint32Array(front.rows);
    const column = front.byName.get(state.colour);
    if (!column) pixels.fill(none);
    else {
      const words = wordColours(column)?.map(page.pixel);
      const table = page.rampPixels(rampOf());
      const place = placeOf(column);
      for (let i = 0; i < pixels.length; i++) {
        if (words) {
          pixels[i] = words[column.values[i]] ?? none;
          continue;
        }
        const t = place(column.values[i]);
        pixels[i] = t >= 0 ? table[Math.min(STEPS - 1, Math.round(t * (STEPS - 1)))] : none;
      }
    }
    cache = { key, pixels, front };
    return pixels;
  };

  const stopsOf = (ramp) => d3.range(0, 1.0001, 0.1).map((t) => ramp(t));

  // A horizontal bar with its ticks: an SVG axis below a strip of CSS gradient.
  page.colourBar = (title, low, high, ramp, width = 240) => {
    const bar = page.element("div", { class: "colour-bar", role: "img", "aria-label": `Colour: ${title}` });
    const strip = page.element("div", { class: "strip" });
    const stops = stopsOf(ramp);
    strip.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    strip.dataset.stops = JSON.stringify(stops);
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
    if (size >= 1e7 || (size < 1e-3 && size > 0)) return d3.format("~e");
    return (value) => {
      const text = format(value).replace(/,/g, "");
      const whole = text.match(/\d+/)?.[0] ?? "";
      return text.replace(whole, page.count(whole));
    };
  };

  page.legend = () => {
    const column = page.front.byName.get(page.state.colour);
    if (!column) return page.element("div", {});
    const title = page.withUnit(column.name, column.unit);
    const ramp = rampOf();
    if (!column.words) return page.colourBar(title, column.low, column.high, ramp);
    const place = placeOf(column);
    const swatch = (word, i) => {
      const square = page.element("span", { class: "swatch" });
      square.style.background = wordColours(column)?.[i] ?? ramp(place(i));
      return page.element("span", { class: "word" }, square, word);
    };
    return page.element("div", { class: "colour-bar" }, page.element("div", { class: "bar-title" }, title), page.element("div", { class: "words" }, column.words.map(swatch)));
  };
}
