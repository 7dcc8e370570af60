// Histograms of all feasible designs, as bars with their counts outside the range.
{
  const WIDTH = 640;
  const HEIGHT = 240;
  const MARGIN = { left: 82, right: 32, top: 10, bottom: 46 };

  const draw = (histogram, number) => {
    const { of, unit, from, to, designs } = histogram;
    const svg = d3.create("svg").attr("viewBox", `0 0 ${WIDTH} ${HEIGHT}`).attr("role", "img").attr("aria-label", `Histogram of ${of}`);
    const x = d3.scaleLinear([from[0], to[to.length - 1]], [MARGIN.left, WIDTH - MARGIN.right]);
    const y = d3.scaleLinear([0, d3.max(designs) || 1], [HEIGHT - MARGIN.bottom, MARGIN.top]);
    const bar = (count, i) => `M${x(from[i]) + 0.3},${y(0)}V${y(count)}H${Math.max(x(from[i]) + 0.8, x(to[i]) - 0.3)}V${y(0)}z`;
    svg.append("g").attr("class", "grid").attr("transform", `translate(${MARGIN.left},0)`).call(d3.axisLeft(y).ticks(4).tickSize(-(WIDTH - MARGIN.left - MARGIN.right)).tickFormat(""));
    svg.append("g").attr("class", "bars-selected").selectAll("path").data(designs).join("path").attr("d", bar);
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${HEIGHT - MARGIN.bottom})`).call(d3.axisBottom(x).ticks(6).tickSizeOuter(0).tickSize(4).tickFormat(page.tick(x, 6)));
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(${MARGIN.left},0)`).call(d3.axisLeft(y).ticks(4).tickSizeOuter(0).tickSize(4).tickFormat((value) => (Number.isInteger(value) ? page.count(value) : "")));
    svg.append("text").attr("class", "axis-title").attr("x", (MARGIN.left + WIDTH - MARGIN.right) / 2).attr("y", HEIGHT - 8).attr("text-anchor", "middle").text(page.axisName(of, unit));
    svg.append("text").attr("class", "axis-title").attr("transform", `translate(13,${(HEIGHT - MARGIN.bottom + MARGIN.top) / 2})rotate(-90)`).attr("text-anchor", "middle").text("feasible designs");
    // The pointer is tested over the full height, so that a low bar is as easy to hit.
    const hit = (event) => {
      const value = x.invert(d3.pointer(event, svg.node())[0]);
      const i = from.findIndex((low, k) => value >= low && value <= to[k]);
      page.tip(event, i < 0 ? "" : `${page.short(from[i])} to ${page.short(to[i])}${unit ? ` ${page.unit(unit)}` : ""}: ${page.count(designs[i])} designs`);
    };
    // The current design and those that are pinned, where the front has this quantity.
    const marks = svg.append("g").attr("class", "marks");
    const mark = () => {
      marks.selectAll("*").remove();
      const column = page.front?.byName.get(of);
      if (!column || column.words) return;
      const isWithin = (at) => at >= MARGIN.left && at <= WIDTH - MARGIN.right;
      const at = x(page.currentValue(of));
      if (isWithin(at)) marks.append("path").attr("class", "current").attr("d", `M${at},${MARGIN.top}V${HEIGHT - MARGIN.bottom}`);
      const pins = page.pins().map((pin) => ({ letter: pin.letter, x: x(page.placeIn(pin.values, column)), y: MARGIN.top + 8 })).filter((pin) => isWithin(pin.x));
      page.drawLetters(marks, pins, [MARGIN.left, MARGIN.top, WIDTH - MARGIN.right, HEIGHT - MARGIN.bottom]);
    };
    for (const event of ["current", "card", "pins"]) page.events.on(`${event}.histogram${number}`, mark);
    mark();
    svg.on("pointermove", hit).on("pointerleave", (event) => page.tip(event, ""));
    return svg.node();
  };

  const figure = (histogram, number) => {
    const { of, doc, below, above, designs } = histogram;
    const total = d3.sum(designs);
    const outside = [below ? `${page.count(below)} below` : "", above ? `${page.count(above)} above` : ""].filter(Boolean).join(", ");
    const plot = total ? draw(histogram, number) : page.element("p", { class: "notice" }, "No feasible design in this range.");
    const caption = page.element("figcaption", {}, page.element("div", { class: "title-line" }, page.element("strong", {}, of), total ? page.saveButtonsOf(`the histogram of ${of}`, `histogram-${of}`, () => plot) : null), doc ? ` ${doc}` : "", page.element("div", { class: "muted" }, `${page.count(total)} designs in the range${outside ? `, ${outside} it` : ", none outside"}.`));
    return page.element("figure", { class: "figure", "data-histogram": of }, caption, plot);
  };

  page.startHistograms = () => {
    const { histograms } = page.data;
    if (!histograms || !histograms.length) return;
    const section = page.byId("histograms");
    section.hidden = false;
    section.append(page.element("h2", { id: "histograms-title" }, "Histograms of the feasible designs"), page.element("div", { class: "figures" }, histograms.map(figure)));
  };
}
