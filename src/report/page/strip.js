// One objective: a histogram of its values on the front, brushed along the axis. Below the bars each design is a tick: those of the front,
// and in lines of their own those of the front before, of other results and of the feasible sample.
{
  const BARS = 150; // px, down to the ticks
  const LINE = 15; // px from one line of ticks to the next
  const MARGIN = { left: 92, right: 20, bottom: 52, top: 16 };
  let strip = null; // { column, scale, group, brush, bars, bins, bar, current, marks, height, pixels }

  const valuesOf = (layer, column) => layer?.byName.get(column.name)?.values;

  // What has ticks, from above: the front and what there is beside it.
  const linesOf = (column) => {
    const others = page.others.map((other) => ({ title: "other result", css: `other-mark ${other.kind}`, values: valuesOf(other, column) }));
    const all = [{ title: "the front", css: "rug", values: column.values }, { title: "old front", css: "rug of-ghost", values: valuesOf(page.ghost, column) }, ...others, { title: "feasible", css: "rug of-sample", values: valuesOf(page.sample, column) }];
    return all.filter(({ values }) => values);
  };
  page.stripHas = (layer) => Boolean(strip && valuesOf(layer, strip.column));
  page.leaveStrip = () => (strip = null);

  // One tick for all designs of half a pixel.
  const ticks = (values, scale, top) => {
    const places = new Set(Array.from(values, (value) => Math.round(2 * scale(value)) / 2));
    return [...places].filter(Number.isFinite).map((x) => `M${x},${top}v8`).join("");
  };

  page.drawStrip = (box, column) => {
    strip = null;
    if (!column) {
      box.append(page.element("p", { class: "notice" }, "No column is chosen for the scatter matrix."));
      return;
    }
    const width = Math.min(900, page.layoutWidth(box));
    const lines = linesOf(column);
    const height = BARS + 6 + LINE * lines.length;
    const svg = d3.create("svg").attr("width", width).attr("height", height + MARGIN.bottom);
    const scale = d3.scaleLinear(page.wideDomain(column), [MARGIN.left, width - MARGIN.right]);
    const count = Math.max(24, Math.min(60, Math.ceil(Math.sqrt(page.front.rows) * 2)));
    const bins = d3.bin().domain(scale.domain()).thresholds(d3.range(1, count).map((i) => scale.domain()[0] + ((scale.domain()[1] - scale.domain()[0]) * i) / count));
    const all = bins(column.values);
    const top = d3.scaleLinear([0, d3.max(all, (bin) => bin.length) || 1], [BARS, MARGIN.top]);
    const bar = (bin) => `M${scale(bin.x0) + 0.5},${top(0)}V${top(bin.length)}H${Math.max(scale(bin.x0) + 1, scale(bin.x1) - 0.5)}V${top(0)}z`;
    svg.append("g").attr("class", "bars-all").selectAll("path").data(all).join("path").attr("d", bar);
    const bars = svg.append("g").attr("class", "bars-selected");
    lines.forEach(({ title, css, values }, at) => {
      const y = BARS + 6 + LINE * at;
      svg.append("path").attr("class", css).attr("data-line", title).attr("d", ticks(values, scale, y));
      svg.append("text").attr("class", "strip-line").attr("x", MARGIN.left - 8).attr("y", y + 8).attr("text-anchor", "end").text(title);
    });
    const across = svg.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${height})`).call(page.axisOf(d3.axisBottom, column, scale, Math.max(2, Math.min(8, Math.floor(width / 90)))));
    if (column.words) page.tiltWords(across, (width - MARGIN.left - MARGIN.right) / column.words.length);
    else page.keepTicksApart(across, width);
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(${MARGIN.left},0)`).call(d3.axisLeft(top).ticks(Math.min(4, top.domain()[1])).tickSize(4).tickFormat(d3.format("~d")));
    page.writeTitle(svg.append("text").attr("class", "axis-title").attr("y", height + 38), page.axisTitle(column, width - MARGIN.left, 1), (width + MARGIN.left) / 2);
    svg.append("text").attr("class", "axis-title").attr("transform", `translate(22,${BARS / 2})rotate(-90)`).attr("text-anchor", "middle").text("designs on the front");
    const marks = svg.append("g").attr("class", "marks");
    const current = svg.append("path").attr("class", "strip-current");
    const group = svg.append("g").attr("class", "cell").attr("data-x", column.name).attr("tabindex", 0).attr("role", "application");
    group.attr("aria-label", `${column.name}: arrow keys go from design to design, Enter opens the card`);
    group.append("rect").attr("class", "frame").attr("x", MARGIN.left).attr("y", MARGIN.top - 8).attr("width", width - MARGIN.left - MARGIN.right).attr("height", height - MARGIN.top + 8);
    const brush = d3.brushX().extent([[MARGIN.left, MARGIN.top], [width - MARGIN.right, height]]);
    strip = { column, scale, brush, bars, bins, bar, current, marks, height, group: group.append("g").attr("class", "brush").call(brush), pixels: width };
    listen(group);
    const readout = page.element("div", { id: "readout", "data-testid": "readout", tabindex: 0, role: "group", "aria-label": "the values of the current design" });
    box.append(page.element("div", { class: "stage" }, svg.node()), readout);
    addMarks();
    update();
    showCurrent();
    page.showReadout();
  };

  // Limits, ends of the searched range, the knee and pinned designs.
  const addMarks = () => {
    const { column, scale, marks, height } = strip;
    marks.selectAll("*").remove();
    const ends = scale.range();
    const within = (at) => at >= ends[0] && at <= ends[1];
    for (const limit of page.limitsOf(column)) {
      const at = scale(limit);
      if (within(at)) marks.append("path").attr("class", "limit").attr("d", `M${at},${MARGIN.top - 8}V${height}`).append("title").text(`limit of ${column.name}: ${page.short(limit)}`);
    }
    page.markEnds(marks, column, scale, (at) => `M${at},${height - 5}v10`, (at, first) => `M${at},${BARS - 6}l${first ? -8 : 8},5l${first ? 8 : -8},5z`, ends);
    const chosen = page.chosenRow();
    const x = chosen === null || chosen === undefined ? NaN : scale(column.values[chosen]);
    if (Number.isFinite(x)) marks.append("path").attr("class", "knee").attr("d", `M${x},${BARS + 4}l6,6l-6,6l-6,-6z`);
    const pins = page.pins().map((pin) => ({ letter: pin.letter, x: scale(page.placeIn(pin.values, column)), y: MARGIN.top })).filter((pin) => within(pin.x));
    page.drawLetters(marks, pins, [ends[0], MARGIN.top - 7, ends[1], BARS]);
  };

  const nearest = (x) => {
    const { column, scale } = strip;
    const row = d3.least(page.selected(), (it) => Math.abs(scale(column.values[it]) - x));
    return row ?? null;
  };

  const listen = (group) => {
    let from = 0;
    const at = (event) => d3.pointer(event.changedTouches ? event.changedTouches[0] : event, group.node())[0];
    strip.brush.on("start", (event) => {
      if (event.sourceEvent) from = at(event.sourceEvent);
    });
    strip.brush.on("brush end", (event) => {
      if (!event.sourceEvent) return;
      const { column, scale, pixels } = strip;
      if (event.type === "end" && Math.abs(at(event.sourceEvent) - from) < 3) {
        update();
        const row = nearest(from);
        return row === null ? null : page.openCard(row);
      }
      page.brushAxis(column.name, event.selection ? page.roundRange(...event.selection.map(scale.invert), pixels, scale.domain()) : null);
    });
    group.on("pointermove", (event) => event.buttons || page.setCurrent(nearest(at(event))));
    group.on("pointerleave", () => page.setCurrent(null));
    group.on("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const { current } = page.state;
      if (step) page.setCurrent(page.nextInOrder(strip.column.name, current, step));
      else if (event.key === "Enter" && current !== null) page.openCard(current);
      else return;
      page.announce(page.state.current);
      event.preventDefault();
      event.stopPropagation();
    });
  };

  const update = () => {
    if (!strip) return;
    const { column, scale, group, brush, bars, bins, bar } = strip;
    const rows = page.selected();
    bars.selectAll("path").data(bins(rows.map((row) => column.values[row]))).join("path").attr("d", bar);
    const wanted = page.state.axes.get(column.name);
    const shown = d3.brushSelection(group.node());
    const place = wanted ? wanted.map(scale) : null;
    if (String(place) !== String(shown)) group.call(brush.move, place);
  };

  const showCurrent = () => {
    if (!strip) return;
    const x = strip.scale(page.currentValue(strip.column.name));
    const [left, right] = strip.scale.range();
    strip.current.attr("d", x >= left && x <= right ? `M${x},${MARGIN.top}V${strip.height}` : null);
  };

  page.startStrip = () => {
    page.events.on("selection.strip", () => page.schedule("strip", update));
    for (const event of ["pins", "choice"]) page.events.on(`${event}.strip`, () => page.schedule("strip marks", () => strip && addMarks()));
    for (const event of ["current", "card"]) page.events.on(`${event}.strip`, showCurrent);
  };
}
