// One objective: a histogram of its values on the front, brushed along the axis; the designs are ticks below it.
{
  const HEIGHT = 170;
  const MARGIN = { left: 74, right: 20, bottom: 52, top: 12 };
  let strip = null; // { column, scale, group, brush, bars }

  page.drawStrip = (box, column) => {
    strip = null;
    if (!column) {
      box.append(page.element("p", { class: "notice" }, "No column is chosen for the scatter matrix."));
      return;
    }
    const width = Math.min(900, page.layoutWidth(box));
    const svg = d3.create("svg").attr("width", width).attr("height", HEIGHT + MARGIN.bottom);
    const scale = d3.scaleLinear(page.domain(column), [MARGIN.left, width - MARGIN.right]);
    const count = Math.max(1, Math.min(60, Math.ceil(Math.sqrt(page.front.rows) * 2)));
    const bins = d3.bin().domain(scale.domain()).thresholds(d3.range(1, count).map((i) => scale.domain()[0] + ((scale.domain()[1] - scale.domain()[0]) * i) / count));
    const all = bins(column.values);
    const top = d3.scaleLinear([0, d3.max(all, (bin) => bin.length) || 1], [HEIGHT - 14, MARGIN.top]);
    const bar = (bin) => `M${scale(bin.x0) + 0.5},${top(0)}V${top(bin.length)}H${Math.max(scale(bin.x0) + 1, scale(bin.x1) - 0.5)}V${top(0)}z`;
    svg.append("g").attr("class", "bars-all").selectAll("path").data(all).join("path").attr("d", bar);
    const bars = svg.append("g").attr("class", "bars-selected");
    svg.append("path").attr("class", "rug").attr("d", d3.map(page.front.rows > 4000 ? [] : column.values, (value) => (Number.isFinite(value) ? `M${scale(value)},${HEIGHT - 10}v8` : "")).join(""));
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${HEIGHT})`).call(page.axisOf(d3.axisBottom, column, scale, 8));
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(${MARGIN.left},0)`).call(d3.axisLeft(top).ticks(Math.min(4, top.domain()[1])).tickSize(4).tickFormat(d3.format("~d")));
    svg.append("text").attr("class", "axis-title").attr("x", (width + MARGIN.left) / 2).attr("y", HEIGHT + 38).attr("text-anchor", "middle").text(page.axisName(column.name, column.unit) + (column.goal ? `, ${column.goal === "min" ? "lower" : "higher"} is better` : ""));
    svg.append("text").attr("class", "axis-title").attr("transform", `translate(22,${HEIGHT / 2})rotate(-90)`).attr("text-anchor", "middle").text("designs on the front");
    const current = svg.append("path").attr("class", "strip-current");
    const group = svg.append("g").attr("class", "cell").attr("data-x", column.name).attr("tabindex", 0).attr("role", "application");
    group.attr("aria-label", `${column.name}: arrow keys go from design to design, Enter opens the card`);
    const brush = d3.brushX().extent([[MARGIN.left, MARGIN.top], [width - MARGIN.right, HEIGHT]]);
    strip = { column, scale, brush, bars, bins, bar, current, group: group.append("g").attr("class", "brush").call(brush), pixels: width };
    listen(group);
    box.append(page.element("div", { class: "stage" }, svg.node()), page.element("div", { id: "readout", "data-testid": "readout" }));
    update();
    page.showReadout();
  };

  const nearest = (x) => {
    const { column, scale } = strip;
    const row = d3.leastIndex(column.values, (a, b) => Math.abs(scale(a) - x) - Math.abs(scale(b) - x));
    return row >= 0 ? row : null;
  };

  const listen = (group) => {
    let from = 0;
    strip.brush.on("start", (event) => {
      if (event.sourceEvent) from = d3.pointer(event.sourceEvent, group.node())[0];
    });
    strip.brush.on("brush end", (event) => {
      if (!event.sourceEvent) return;
      const { column, scale, pixels } = strip;
      if (event.type === "end" && Math.abs(d3.pointer(event.sourceEvent, group.node())[0] - from) < 3) {
        update();
        const row = nearest(from);
        return row === null ? null : page.openCard(row);
      }
      page.brushAxis(column.name, event.selection ? page.roundRange(...event.selection.map(scale.invert), pixels, scale.domain()) : null);
    });
    group.on("pointermove", (event) => event.buttons || page.setCurrent(nearest(d3.pointer(event, group.node())[0])));
    group.on("pointerleave", () => page.setCurrent(null));
    group.on("keydown", (event) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      const { current } = page.state;
      if (step) page.setCurrent(page.nextInOrder(strip.column.name, current, step));
      else if (event.key === "Enter" && current !== null) page.openCard(current);
      else return;
      event.preventDefault();
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

  page.startStrip = () => {
    page.events.on("selection.strip", () => page.schedule("strip", update));
    page.events.on("current.strip", () => {
      if (!strip) return;
      const row = page.state.current;
      const x = row === null ? NaN : strip.scale(strip.column.values[row]);
      strip.current.attr("d", Number.isFinite(x) ? `M${x},${MARGIN.top}V${HEIGHT}` : null);
    });
  };
}
