// What is around a design: every objective and constraint along each input, all else as it is.
{
  const WIDTH = 196;
  const HEIGHT = 92;
  const PAD = { left: 44, right: 16, top: 8, bottom: 20 };
  let asking = null;

  // How far the input can go from the design's own value before it is infeasible.
  const reach = ({ at, feasible, own }) => {
    const here = at.indexOf(own);
    let [low, high] = [here, here];
    while (low > 0 && feasible[low - 1]) low--;
    while (high < at.length - 1 && feasible[high + 1]) high++;
    if (!feasible[here]) return null;
    return { low: at[low], high: at[high], lowEnd: low === 0, highEnd: high === at.length - 1 };
  };

  const reachText = (slice) => {
    const found = reach(slice);
    const unit = slice.unit ? ` ${page.unit(slice.unit)}` : "";
    if (!found) return "this design is infeasible";
    const end = (isEnd, value) => (isEnd ? `the end of its axis, ${page.short(value)}` : page.short(value));
    return `feasible from ${end(found.lowEnd, found.low)} to ${end(found.highEnd, found.high)}${unit}, all else as it is`;
  };

  const limitsOf = (name) => {
    const known = page.front.constraints.find((it) => it.of === name || (it.column && it.column.name === name));
    return known ? [known.min, known.above, known.max, known.below].filter((it) => it !== null && it !== undefined) : [];
  };

  const chart = (slice, column, line) => {
    const values = line.values.map((it) => (it === null ? NaN : it));
    const limits = limitsOf(column.name);
    const finite = values.filter(Number.isFinite);
    if (!finite.length) return null;
    const [low, high] = d3.extent([...finite, ...limits.filter((it) => it >= d3.min(finite) - (d3.max(finite) - d3.min(finite)) && it <= d3.max(finite) + (d3.max(finite) - d3.min(finite)))]);
    const x = d3.scaleLinear([slice.at[0], slice.at[slice.at.length - 1]], [PAD.left, WIDTH - PAD.right]);
    const y = d3.scaleLinear(low === high ? [low - (Math.abs(low) || 1) * 0.1, high + (Math.abs(high) || 1) * 0.1] : [low, high], [HEIGHT - PAD.bottom, PAD.top]).nice(3);
    const svg = d3.create("svg").attr("class", "slice").attr("width", WIDTH).attr("height", HEIGHT).attr("role", "img");
    svg.attr("aria-label", `${column.name} over ${slice.input}: ${page.short(finite[0])} to ${page.short(finite[finite.length - 1])}`);
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${HEIGHT - PAD.bottom})`).call(d3.axisBottom(x).ticks(3).tickSizeOuter(0).tickSize(3).tickFormat(page.tick(x, 3)));
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(${PAD.left},0)`).call(d3.axisLeft(y).ticks(3).tickSizeOuter(0).tickSize(3).tickFormat(page.tick(y, 3)));
    // Where the design would be infeasible.
    const half = (i) => (i < 0 ? slice.at[0] : i >= slice.at.length - 1 ? slice.at[slice.at.length - 1] : (slice.at[i] + slice.at[i + 1]) / 2);
    slice.feasible.forEach((is, i) => is || svg.append("rect").attr("class", "no-go").attr("x", x(half(i - 1))).attr("width", Math.max(0, x(half(i)) - x(half(i - 1)))).attr("y", PAD.top).attr("height", HEIGHT - PAD.top - PAD.bottom));
    for (const limit of limits) if (limit >= y.domain()[0] && limit <= y.domain()[1]) svg.append("path").attr("class", "limit").attr("d", `M${PAD.left},${y(limit)}H${WIDTH - PAD.right}`);
    const path = d3.line((_, i) => x(slice.at[i]), (value) => y(value)).defined(Number.isFinite);
    if (slice.at.length === 1) svg.append("circle").attr("class", "own").attr("r", 3).attr("cx", x(slice.at[0])).attr("cy", y(values[0]));
    else svg.append("path").attr("class", "slice-line").attr("d", path(values));
    // Where another scenario becomes the worst.
    line.scenarios.forEach((scenario, i) => {
      if (i > 0 && scenario !== null && line.scenarios[i - 1] !== null && scenario !== line.scenarios[i - 1] && Number.isFinite(values[i])) {
        svg.append("path").attr("class", "switch").attr("d", `M${x(half(i - 1))},${y((values[i] + values[i - 1]) / 2) - 5}v10`).append("title").text(`from here on the worst scenario is #${scenario}`);
      }
    });
    const here = slice.at.indexOf(slice.own);
    if (Number.isFinite(values[here])) svg.append("circle").attr("class", "own").attr("r", 3.5).attr("cx", x(slice.own)).attr("cy", y(values[here]));
    return svg.node();
  };

  const draw = (box, { columns, slices }) => {
    const head = page.element("tr", {}, page.element("th", { scope: "col" }, "input"), columns.map((column) => page.element("th", { scope: "col", title: column.doc }, page.breakable(column.name), page.element("span", { class: "unit" }, ` ${page.unit(column.unit)}`))));
    const rows = slices.map((slice) => page.element("tr", {}, page.element("th", { scope: "row" }, page.breakable(slice.input), page.element("div", { class: "unit" }, reachText(slice))), slice.lines.map((line, i) => page.element("td", {}, chart(slice, columns[i], line)))));
    box.replaceChildren(page.element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Slices around the design" }, page.element("table", { class: "slices", "data-testid": "slices" }, page.element("thead", {}, head), page.element("tbody", {}, rows))), page.element("p", { class: "hint" }, "Dot: this design. Dashed: a limit. Shaded: infeasible. A tick on a line: another scenario becomes the worst."));
  };

  const ask = async () => {
    const section = page.byId("around");
    const row = page.state.card ?? (page.front ? page.front.knee : null);
    if (asking) asking.abort();
    if (row === null || row === undefined) return (section.hidden = true);
    section.hidden = false;
    const design = page.designOf(row);
    const title = `Around design ${design}${page.state.card === null ? " (knee)" : ""}`;
    const box = section.querySelector(".around-box") || page.element("div", { class: "around-box" });
    section.replaceChildren(page.element("h2", { id: "around-title" }, title), box);
    asking = new AbortController();
    try {
      draw(box, await page.askOnce("/around", { set: page.changeList(), design }, asking.signal));
      page.timings.around = performance.now();
    } catch (error) {
      if (error.name !== "AbortError") box.replaceChildren(page.element("p", { class: "notice" }, error.message));
    }
    return null;
  };

  // All outputs of the design of the card.
  const askOutputs = async () => {
    const row = page.state.card;
    const box = page.byId("all-outputs");
    if (row === null || !box) return;
    const set = page.changeList();
    const design = page.designOf(row);
    try {
      const told = await page.askOnce("/design", { set, design });
      if (page.state.card === null || page.designOf(page.state.card) !== design || !page.byId("all-outputs")) return;
      const known = new Set(page.front.shown.map((column) => column.name));
      const lines = told.outputs.filter((output) => !known.has(output.name)).map((output) =>
        page.element("tr", {}, page.element("th", { scope: "row", title: output.doc }, page.breakable(output.name)), page.element("td", { class: "number" }, page.element("span", { "data-name": output.name, "data-value": page.full(output.value), title: page.full(output.value) }, page.short(output.value)), page.element("span", { class: "unit" }, output.value === null ? "" : ` ${page.unit(output.unit)}`)), page.element("td", { class: "scenario" }, output.scenario === null ? "" : `#${output.scenario}`)),
      );
      page.byId("all-outputs").replaceChildren(page.element("h3", {}, "All other outputs"), page.element("table", { class: "values" }, page.element("tbody", {}, lines)));
    } catch (error) {
      box.replaceChildren(page.element("p", { class: "notice" }, error.message));
    }
  };

  page.startAround = () => {
    let waiting = 0;
    const later = (wait) => {
      clearTimeout(waiting);
      waiting = setTimeout(ask, wait);
    };
    // The card is drawn anew with another front and with each pin: its list of outputs too.
    let outputs = 0;
    const laterOutputs = (wait) => {
      clearTimeout(outputs);
      outputs = setTimeout(askOutputs, wait);
    };
    page.events.on("front.around", () => {
      later(500);
      laterOutputs(500);
    });
    page.events.on("pins.around", () => laterOutputs(0));
    page.events.on("card.around", () => {
      later(60);
      laterOutputs(0);
    });
    later(300);
  };
}
