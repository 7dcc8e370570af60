// Parallel coordinates: the axes, their brushes and titles. The lines are drawn in lines.js.
{
  const HEIGHT = 300;
  const LEAST = 60; // px from axis to axis
  const PAD = 10;
  const NARROW = 74; // px: narrower axes have smaller titles of more lines
  const TIGHT = 60; // px: and here of even smaller letters
  const headOfStep = (step) => (page.printing ? 62 : step < NARROW ? 112 : 92); // room for titles and, but on paper, buttons
  let axes = []; // { column, x, scale, group, brush }
  let stage, svg, width;

  const scaleOf = (column) => {
    const range = page.state.inverted.has(column.name) ? [PAD, HEIGHT - PAD] : [HEIGHT - PAD, PAD];
    return d3.scaleLinear(page.domain(column), range);
  };

  const nameCrowd = () => {
    page.byId("crowd-hint").textContent = page.isCrowdOfLines(page.front.rows) ? ` ${page.denser()}: more lines in one place.` : "";
  };

  // A column that is the same for every design on the front has no axis; its value is written above.
  const showConstant = () => {
    const { front } = page;
    const same = front.shown.filter((column) => column.role === "design" && column.low === column.high && !page.state.parallel.includes(column.name));
    const texts = same.map((column) => `${column.name} ${page.valueText(column, 0)}${column.unit && !column.words ? ` ${page.unit(column.unit)}` : ""}`);
    page.byId("constant").textContent = texts.length ? `The same for every design of the front: ${texts.join(", ")}.` : "";
  };

  const layout = () => {
    const { state, front } = page;
    const box = page.byId("parallel");
    axes = [];
    page.byId("parallel-section").hidden = !front.rows;
    if (!front.rows) return;
    if (!state.parallel.length) {
      box.replaceChildren(page.element("p", { class: "notice" }, "No axis is chosen."));
      page.layoutLines(null);
      return;
    }
    showConstant();
    width = Math.floor(Math.max(page.layoutWidth(box), page.printing ? 0 : state.parallel.length * LEAST));
    const xs = d3.scalePoint(state.parallel, [0, width]).padding(0.5);
    const canvas = page.element("canvas", { "aria-hidden": "true" });
    svg = d3.create("svg").attr("width", width).attr("height", HEIGHT + 4);
    stage = page.element("div", { class: "stage" }, canvas, svg.node());
    stage.style.width = `${width}px`;
    const head = headOfStep(xs.step());
    stage.style.height = `${head + HEIGHT + 4}px`;
    canvas.style.top = svg.node().style.top = `${head}px`;
    for (const name of state.parallel) {
      const column = front.byName.get(name);
      const axis = { column, x: xs(name), scale: scaleOf(column) };
      addAxis(axis);
      stage.append(headOf(axis, xs.step()));
      axes.push(axis);
    }
    page.keepFocus(box, () => {
      box.replaceChildren(stage);
      page.oneStop(stage, ".axis-buttons button");
    });
    nameCrowd();
    page.layoutLines({ canvas, width, height: HEIGHT, axes });
    syncBrushes();
    showPins();
    showCurrent();
  };

  const addAxis = (axis) => {
    const { column, scale } = axis;
    const group = svg.append("g").attr("class", "axis").attr("data-name", column.name).attr("transform", `translate(${axis.x},0)`);
    // The words of the first axis are to its right: there is no room to its left.
    const side = column.words && page.state.parallel[0] === column.name ? d3.axisRight : d3.axisLeft;
    const ticks = group.append("g").attr("class", "tick-axis halo").call(page.axisOf(side, column, scale, 6));
    // Those of the first axis end before the numbers of the next one.
    const room = page.state.parallel[0] === column.name ? Math.max(5, Math.floor((width / page.state.parallel.length - 46) / 6)) : 11;
    if (column.words) page.shortenWords(ticks, room);
    for (const limit of page.limitsOf(column)) {
      const at = scale(limit);
      if (at >= 0 && at <= HEIGHT) group.append("path").attr("class", "limit").attr("d", `M-9,${at}h18`).append("title").text(`limit of ${column.name}: ${page.short(limit)}`);
    }
    page.markEnds(group, column, scale, (at) => `M-5,${at}h10`, (at, up) => `M-5,${at}l5,${up ? -8 : 8}l5,${up ? 8 : -8}z`, [0, HEIGHT]);
    axis.dot = group.append("circle").attr("class", "current").attr("r", 4).attr("display", "none");
    axis.brush = d3.brushY().extent([[-9, 0], [9, HEIGHT]]).handleSize(8);
    axis.group = group.append("g").attr("class", "brush").call(axis.brush);
    axis.brush.on("brush end", (event) => {
      if (!event.sourceEvent) return;
      const range = event.selection ? page.roundRange(...event.selection.map(scale.invert), HEIGHT, scale.domain()) : null;
      page.brushAxis(column.name, range);
    });
    group.on("pointermove", (event) => {
      if (event.buttons) return;
      const y = d3.pointer(event, group.node())[1];
      page.setCurrent(nearestOn(axis, y));
    });
    group.on("pointerleave", () => page.setCurrent(null));
  };

  // Ends of the searched range as bars across the axis, limits beyond its ends as arrows.
  page.markEnds = (group, column, scale, bar, arrow, [top, bottom]) => {
    for (const end of page.searchedOf(column) || []) group.append("path").attr("class", "range-end").attr("d", bar(scale(end))).append("title").text(`end of the searched range: ${page.short(end)}`);
    for (const limit of page.limitsOf(column)) {
      const at = scale(limit);
      if (at < top || at > bottom) group.append("path").attr("class", "limit-beyond").attr("d", arrow(at < top ? top + 8 : bottom - 8, at < top)).append("title").text(`limit of ${column.name}: ${page.short(limit)}, beyond this axis`);
    }
  };

  const nearestOn = ({ column, scale }, y) => {
    let best = null;
    let least = 8;
    for (let i = 0; i < column.values.length; i++) {
      const d = page.mask[i] ? Math.abs(scale(column.values[i]) - y) : Infinity;
      if (d < least) [best, least] = [i, d];
    }
    return best;
  };

  const headOf = (axis, step) => {
    const { column } = axis;
    const { state } = page;
    const place = state.parallel.indexOf(column.name);
    const inverted = state.inverted.has(column.name);
    const button = (what, label, text, disabled, click, pressed = null) =>
      page.element("button", { type: "button", "aria-label": `${label} ${column.name}`, title: label, disabled, click, "aria-pressed": pressed, "data-focus": `${what} ${column.name}` }, text);
    const role = column.goal ? column.goal : column.role === "design" ? "input" : "";
    const title = page.element("div", { class: "axis-name", title: `${column.name}${column.unit ? ` [${page.unit(column.unit)}]` : ""}${column.doc ? `: ${column.doc}` : ""}` }, page.axisWords(column.name, column.unit));
    const words = [column.unit ? `[${page.unit(column.unit)}]` : "", role].filter(Boolean);
    const sub = page.element("div", { class: "axis-unit" }, words.flatMap((word, i) => [i ? " " : "", page.element("span", {}, word)]));
    const buttons = page.element(
      "div",
      { class: "axis-buttons no-print" },
      button("left", "Move to the left:", "‹", place === 0, () => page.moveAxis(column.name, place - 1)),
      button("invert", "Reverse:", "⇅", false, () => page.invertAxis(column.name), String(inverted)),
      button("right", "Move to the right:", "›", place === state.parallel.length - 1, () => page.moveAxis(column.name, place + 1)),
    );
    const head = page.element("div", { class: `axis-head${step < NARROW ? " narrow" : ""}${step < TIGHT ? " tight" : ""}`, "data-axis": column.name }, title, sub, buttons);
    head.style.left = `${axis.x - step / 2}px`;
    head.style.width = `${step}px`;
    dragBy(title, head, axis, step);
    return head;
  };

  // Dragging a title moves its axis to where it is dropped.
  const dragBy = (title, head, axis, step) => {
    title.addEventListener("pointerdown", (down) => {
      if (down.button) return;
      down.preventDefault();
      title.setPointerCapture(down.pointerId);
      const place = page.state.parallel.indexOf(axis.column.name);
      const group = svg.selectAll(".axis").filter(function () {
        return this.dataset.name === axis.column.name;
      });
      let moved = 0;
      const move = (event) => {
        moved = event.clientX - down.clientX;
        head.style.transform = `translateX(${moved}px)`;
        head.classList.add("dragged");
        group.attr("transform", `translate(${axis.x + moved},0)`);
      };
      const drop = () => {
        title.removeEventListener("pointermove", move);
        const to = Math.round(place + moved / step);
        page.moveAxis(axis.column.name, to);
      };
      title.addEventListener("pointermove", move);
      title.addEventListener("pointerup", drop, { once: true });
      title.addEventListener("pointercancel", drop, { once: true });
    });
  };

  const syncBrushes = () => {
    for (const { column, scale, brush, group } of axes) {
      const wanted = page.state.axes.get(column.name);
      const shown = d3.brushSelection(group.node());
      if (!wanted) {
        if (shown) group.call(brush.move, null);
        continue;
      }
      if (shown && String(page.roundRange(...shown.map(scale.invert), HEIGHT, scale.domain())) === String(wanted)) continue;
      const clip = (value) => Math.max(0, Math.min(HEIGHT, scale(value)));
      group.call(brush.move, wanted.map(clip).sort((a, b) => a - b));
    }
  };

  const showCurrent = () => {
    if (!svg) return;
    svg.selectAll(".current-line").remove();
    const places = axes.map((axis) => [axis.x, axis.scale(page.currentValue(axis.column.name))]);
    const isWithin = ([, y]) => y >= 0 && y <= HEIGHT;
    axes.forEach(({ dot }, at) => dot.attr("display", isWithin(places[at]) ? null : "none").attr("cy", isWithin(places[at]) ? places[at][1] : 0));
    if (places.some(isWithin)) svg.insert("path", ".axis").attr("class", "current-line").attr("d", d3.line().defined(isWithin)(places));
  };

  // Pinned designs as lines with their letters.
  const showPins = () => {
    if (!svg) return;
    svg.selectAll(".pinned").remove();
    const ends = [];
    for (const pin of page.pins()) {
      const places = axes.map((axis) => [axis.x, axis.scale(page.placeIn(pin.values, axis.column))]).filter(([, y]) => Number.isFinite(y) && y >= 0 && y <= HEIGHT);
      if (!places.length) continue;
      const group = svg.insert("g", ".axis").attr("class", "pinned");
      group.append("path").attr("class", "pin-line").attr("d", d3.line()(places));
      for (const [x, y] of places) group.append("circle").attr("class", "pin-dot").attr("r", 2.5).attr("cx", x).attr("cy", y);
      const [x, y] = places[places.length - 1];
      ends.push({ letter: pin.letter, x, y });
    }
    // To the right of the axes, where no lines are.
    page.drawLetters(svg.append("g").attr("class", "pinned"), ends, [width - width / axes.length / 2 + 11, 8, width - 8, HEIGHT - 6], 14);
  };

  page.startParallel = () => {
    page.saveButtons(page.byId("parallel-title"), "designs");
    layout();
    page.events.on("columns.parallel", layout);
    page.events.on("layout.parallel", layout);
    // Thousands of lines take longer than the points: not while a slider moves.
    const later = page.afterPause(140, layout);
    page.events.on("front.parallel", () => {
      page.layoutLines(null);
      later();
    });
    page.events.on("selection.parallel", () => {
      syncBrushes();
      page.redrawLines("brush");
    });
    page.events.on("colour.parallel", () => page.redrawLines("brush"));
    page.events.on("theme.parallel", () => {
      nameCrowd();
      page.redrawLines("all");
    });
    page.events.on("pins.parallel", showPins);
    page.events.on("current.parallel", showCurrent);
    page.events.on("card.parallel", showCurrent);
  };
}
