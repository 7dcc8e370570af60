// Slices around a design: every objective and constraint along each input, all else as it is, with limits, and how far the input can go.
{
  const WIDTH = 196;
  const HEIGHT = 92;
  const PAD = { right: 16, top: 8, bottom: 20 };
  const DIGIT = 6.4; // px of a digit of the ticks
  // How far the input can go from the design's own value before it is infeasible: the last feasible place on either side and the next one.
  const reach = ({ at, feasible, own }) => {
    const here = at.indexOf(own);
    if (!feasible[here]) return null;
    const until = (by) => {
      let last = here;
      while (feasible[last + by]) last += by;
      return { last, next: last + by >= 0 && last + by < at.length ? last + by : null };
    };
    return { down: until(-1), up: until(1) };
  };

  // What the design fails at in a place: the first bound that does not hold, or why it has no result.
  const failsAt = (slice, columns, place) => {
    if (slice.status && slice.status[place]) return slice.status[place];
    for (const bound of page.front.constraints) {
      const name = bound.column ? bound.column.name : bound.of;
      const at = columns.findIndex((column) => column.name === name);
      const value = at < 0 ? null : slice.lines[at].values[place];
      if (value === null) continue;
      const given = (limit) => limit !== null && limit !== undefined;
      if ((given(bound.min) && value < bound.min) || (given(bound.above) && value <= bound.above)) return `${name} is too low`;
      if ((given(bound.max) && value > bound.max) || (given(bound.below) && value >= bound.below)) return `${name} is too high`;
    }
    return "infeasible";
  };

  // Words have no order: which of them are feasible too.
  const wordsText = (slice, columns) => {
    const here = slice.at.indexOf(slice.own);
    const words = slice.words.map(page.wordText);
    const others = words.map((word, i) => ({ word, i })).filter(({ i }) => i !== here);
    const good = others.filter(({ i }) => slice.feasible[i]).map(({ word }) => word);
    const told = good.length > 6 ? `${page.count(good.length)} of ${page.count(others.length)} others` : good.join("; ");
    const bad = others.find(({ i }) => !slice.feasible[i]);
    const lines = [`now ${words[here]}`, slice.feasible[here] ? `feasible too: ${told || "none of the others"}` : "this design is infeasible"];
    return bad ? [...lines, `with ${bad.word}: ${failsAt(slice, columns, bad.i)}`] : lines;
  };

  // Two numbers that differ, in as few digits as show it.
  const toldApart = (a, b) => {
    if (b === null || page.short(a) !== page.short(b)) return [page.short(a), b === null ? "" : page.short(b)];
    const digits = [5, 6, 7, 8, 9, 10, 12].find((it) => Number(a.toPrecision(it)) !== Number(b.toPrecision(it))) ?? 17;
    return [a, b].map((it) => page.full(Number(it.toPrecision(digits))));
  };

  // How far until infeasible, in words.
  const reachText = (slice, columns) => {
    if (slice.words) return wordsText(slice, columns);
    const found = reach(slice);
    const unit = slice.unit ? ` ${page.unit(slice.unit)}` : "";
    if (!found) return "this design is infeasible";
    // An end of what the scenarios say goes as far as the other values of the input, all else as far as its slider.
    const towardsOthers = !slice.isGiven ? "" : slice.input.endsWith(", the largest") ? "down" : slice.input.endsWith(", the least") ? "up" : "";
    const way = (word, { last, next }) => {
      const free = Math.abs(slice.at[last] - slice.own);
      const [shown, beyond] = toldApart(slice.at[last], next === null ? null : slice.at[next]);
      const end = `${shown}${unit}`;
      if (next === null && word === towardsOthers) return `${word} by ${page.short(free)} to ${end}, not beyond its other values`;
      if (next === null && slice.isGiven) return free === 0 ? `${word}: not looked at` : `${word} by ${page.short(free)} to ${end}, as far as this looks`;
      if (next === null) return free === 0 ? `${word}: it is at the end of its axis` : `${word} by ${page.short(free)} to ${end}, the end of its axis`;
      const fails = `at ${beyond}${unit} ${failsAt(slice, columns, next)}`;
      return free === 0 ? `${word}: not at all, ${fails}` : `${word} by ${page.short(free)} to ${end}; ${fails}`;
    };
    return [`now ${page.short(slice.own)}${unit}`, way("down", found.down), way("up", found.up)];
  };

  const limitsOf = (name) => {
    const known = page.front.constraints.filter((it) => it.of === name || (it.column && it.column.name === name));
    return known.flatMap((it) => [it.min, it.above, it.max, it.below]).filter((it) => it !== null && it !== undefined);
  };

  const valuesOf = (line) => line.values.map((it) => (it === null ? NaN : it));

  // What differs in its last digits only is the same everywhere, and so is what has no value anywhere: told in words.
  const isSame = (line) => {
    const [least, most] = d3.extent(valuesOf(line).filter(Number.isFinite));
    return least === undefined || most - least <= 1e-9 * Math.max(Math.abs(least), Math.abs(most));
  };
  const sameText = (slice, columns) => {
    const told = slice.lines.map((line, i) => [columns[i], line]).filter(([, line]) => isSame(line));
    if (!told.length) return [];
    const each = ([column, line]) => {
      const value = valuesOf(line).find(Number.isFinite);
      const limits = limitsOf(column.name).map(page.short).join(" and ");
      return value === undefined ? `${column.name} has no value` : `${column.name} ${page.short(value)}${column.unit ? ` ${page.unit(column.unit)}` : ""}${limits ? ` (limit ${limits})` : ""}`;
    };
    return [`leaves unchanged ${told.map(each).join(", ")}`];
  };

  // As many ticks as have room beside each other.
  const ticksOf = (x, format) => [3, 2, 1].map((count) => x.ticks(count)).find((ticks) => ticks.length < 2 || x(ticks[1]) - x(ticks[0]) > 12 + (DIGIT * (format(ticks[0]).length + format(ticks[1]).length)) / 2) ?? x.ticks(3).slice(0, 1);

  // At the edge of a chart, towards a limit that it does not reach.
  const arrow = (isAbove) => {
    const [tip, base] = isAbove ? [PAD.top, PAD.top + 6] : [HEIGHT - PAD.bottom, HEIGHT - PAD.bottom - 6];
    return `M${WIDTH - PAD.right - 6},${tip}l4,${base - tip}h-8z`;
  };

  const chart = (slice, column, line) => {
    const values = valuesOf(line);
    const limits = limitsOf(column.name);
    const finite = values.filter(Number.isFinite);
    const [least, most] = d3.extent(finite);
    const [low, high] = d3.extent([...finite, ...limits.filter((it) => it >= least - (most - least) && it <= most + (most - least))]);
    const y = d3.scaleLinear(low === high ? [low - (Math.abs(low) || 1) * 0.1, high + (Math.abs(high) || 1) * 0.1] : [low, high], [HEIGHT - PAD.bottom, PAD.top]).nice(3);
    const ofY = page.tick(y, 3);
    // The numbers beside the axis have the room that they need.
    const left = 8 + DIGIT * Math.max(4, d3.max(y.ticks(3), (tick) => ofY(tick).length));
    const ends = [slice.at[0], slice.at[slice.at.length - 1]];
    const pad = slice.words ? (ends[1] - ends[0]) * 0.06 || 1 : 0;
    const x = d3.scaleLinear([ends[0] - pad, ends[1] + pad], [left, WIDTH - PAD.right]);
    const svg = d3.create("svg").attr("class", "slice").attr("viewBox", `0 0 ${WIDTH} ${HEIGHT}`).attr("width", WIDTH).attr("height", HEIGHT).attr("role", "img");
    svg.attr("aria-label", `${column.name} over ${slice.input}: ${page.short(finite[0])} to ${page.short(finite[finite.length - 1])}`);
    const ofX = page.tick(x, 3);
    const bottom = d3.axisBottom(x).tickSizeOuter(0).tickSize(3);
    const across = svg.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${HEIGHT - PAD.bottom})`);
    across.call(slice.words ? bottom.tickValues([]) : bottom.tickValues(ticksOf(x, ofX)).tickFormat(ofX));
    // At the ends they stay within the plot: neither cut off nor over those of the other axis.
    across.selectAll(".tick text").attr("text-anchor", (tick) => (x(tick) < left + 14 ? "start" : x(tick) > WIDTH - PAD.right - 6 ? "end" : "middle"));
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(${left},0)`).call(d3.axisLeft(y).ticks(3).tickSizeOuter(0).tickSize(3).tickFormat(ofY));
    // Where the design would be infeasible.
    const half = (i) => (i < 0 ? x.domain()[0] : i >= slice.at.length - 1 ? x.domain()[1] : (slice.at[i] + slice.at[i + 1]) / 2);
    slice.feasible.forEach((is, first) => {
      if (is || slice.feasible[first - 1] === false) return;
      const next = slice.feasible.indexOf(true, first);
      const [from, to] = [half(first - 1), half(next < 0 ? slice.at.length - 1 : next - 1)].map(x);
      const band = (name, y, height) => svg.append("rect").attr("class", name).attr("x", from).attr("width", Math.max(0, to - from)).attr("y", y).attr("height", height);
      band("no-go", PAD.top, HEIGHT - PAD.top - PAD.bottom);
      band("no-go-line", HEIGHT - PAD.bottom - 3, 3);
    });
    for (const limit of limits) {
      const isAbove = limit > y.domain()[1];
      if (!isAbove && limit >= y.domain()[0]) svg.append("path").attr("class", "limit").attr("d", `M${left},${y(limit)}H${WIDTH - PAD.right}`);
      else svg.append("path").attr("class", "limit-beyond").attr("d", arrow(isAbove)).append("title").text(`limit of ${column.name}: ${page.short(limit)}, beyond this chart`);
    }
    const path = d3.line((_, i) => x(slice.at[i]), (value) => y(value)).defined(Number.isFinite);
    if (slice.words) values.forEach((value, i) => Number.isFinite(value) && svg.append("circle").attr("class", "slice-dot").attr("r", 2.5).attr("cx", x(slice.at[i])).attr("cy", y(value)).append("title").text(`${page.wordText(slice.words[i])}: ${page.short(value)}`));
    else svg.append("path").attr("class", "slice-line").attr("d", path(values));
    // Where another scenario becomes the worst.
    line.scenarios.forEach((scenario, i) => {
      if (i > 0 && !slice.words && scenario !== null && line.scenarios[i - 1] !== null && scenario !== line.scenarios[i - 1] && Number.isFinite(values[i])) {
        svg.append("path").attr("class", "switch").attr("d", `M${x(half(i - 1))},${y((values[i] + values[i - 1]) / 2) - 5}v10`).append("title").text(`from here on the worst scenario is #${scenario}`);
      }
    });
    const here = slice.at.indexOf(slice.own);
    if (Number.isFinite(values[here])) svg.append("circle").attr("class", "own").attr("r", 3.5).attr("cx", x(slice.own)).attr("cy", y(values[here]));
    return svg.node();
  };

  let isUnfolded = false; // the inputs that the study leaves out

  page.drawSlices = (box, { columns, slices, given = 0, defaults = 0, given_left_out: isLeftOut = false }) => {
    const caption = (column) => page.element("figcaption", { title: column.doc }, page.breakable(column.name), column.unit ? page.element("span", { class: "unit" }, ` ${page.unit(column.unit)}`) : null);
    const cell = (slice, column, line) => (isSame(line) ? null : page.element("figure", { class: "slice-cell" }, caption(column), chart(slice, column, line)));
    const text = (slice) => [reachText(slice, columns), sameText(slice, columns)].flat().map((line) => page.element("div", { class: "unit" }, line));
    slices.forEach((slice, i) => (slice.isGiven = i >= slices.length - given));
    const row = (slice) => page.element("div", { class: "slice-row" }, page.element("div", { class: "slice-head" }, page.element("h3", {}, page.breakable(slice.input)), text(slice)), page.element("div", { class: "slice-cells" }, slice.lines.map((line, i) => cell(slice, columns[i], line))));
    const group = (from, to) => slices.slice(from, to).map(row);
    const [ofGiven, ofDefaults] = [slices.length - given, slices.length - defaults];
    const saidOtherwise = ofGiven < ofDefaults ? [page.element("h3", { class: "slice-group" }, "With other loads, uncertainties and fixed values"), ...group(ofGiven, ofDefaults)] : [];
    // What is folded up is drawn once somebody looks.
    const unfold = ({ target }) => {
      isUnfolded = target.open;
      if (isUnfolded && target.children.length === 1) target.append(...group(ofDefaults));
    };
    const leftOut = defaults > 0 ? page.element("details", { class: "slice-group", open: isUnfolded, toggle: unfold }, page.element("summary", { "data-focus": "defaults" }, `With other values of what the study leaves out or takes from a preset (${page.count(defaults)})`), isUnfolded ? group(ofDefaults) : null) : [];
    const list = page.element("div", { class: "slices", "data-testid": "slices" }, group(0, ofGiven), saidOtherwise, leftOut);
    const hint = page.element("p", { class: "hint" }, "Along each axis of the study, all else as it is. Dot: this design. Dashed: a limit. Shaded above a thick line: infeasible. A tick on a line: another scenario becomes the worst. An arrow: a limit beyond the chart.");
    const note = isLeftOut ? page.element("p", { class: "hint", "data-testid": "given-left-out" }, "Other loads, uncertainties and fixed values are left out: they would take too long, or too much of this page.") : "";
    page.keepFocus(box, () => box.replaceChildren(page.element("div", { class: "title-line" }, hint, page.saveButtonsOf("what is around the design", "around", () => list)), list, note));
  };

  // The page of a result holds those of the knee only.
  page.startKneeSlices = () => {
    const { around } = page.data;
    if (!around) return;
    const section = page.byId("around");
    section.hidden = false;
    const others = page.element("p", { class: "hint", "data-testid": "around-note" }, "This page holds the slices of the knee only; ", page.element("code", {}, "beltspace explore"), " draws them for every design.");
    const title = page.element("h2", { id: "around-title" }, `Around design ${around.design} (knee)`);
    if (around.left_out) return section.replaceChildren(title, page.element("p", { class: "hint", "data-testid": "around-note" }, "Slices around the knee take too long to compute for this page; ", page.element("code", {}, "beltspace explore"), " draws them."));
    const box = page.element("div", { class: "around-box" });
    section.replaceChildren(title, others, box);
    page.drawSlices(box, around);
  };
}
