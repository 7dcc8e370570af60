// The scatter matrix: one canvas for the points of all cells, one SVG over it for axes, brushes and marks.
{
  const GAP = 14;
  const LEFT = 74;
  const BOTTOM = 50;
  const TITLES = BOTTOM + 26; // where they have three lines
  const TOP = 8;
  const LEAST = 76; // px of a cell
  const LEAST_ON_PAPER = 64;
  let cells = []; // { x, y, left, top, xs, ys, image, base, brush, group }
  let canvas, svg, size, ratio, disc, dot;
  let crowd = null; // of the cell that is drawn
  let densest; // of all cells

  const sizeFor = (width, count) => {
    const across = count - 1;
    const room = (width - LEFT - GAP * across) / across;
    // One cell has the values of the current design beside it, or below where there is no room.
    if (across === 1) return width < 700 && !page.printing ? Math.max(220, Math.min(440, width - LEFT - 16)) : Math.max(220, Math.min(page.printing ? 340 : 460, width - LEFT - 330));
    // On paper it stands on the first page, below the question, if there is room for cells that can be read.
    if (page.printing) {
      const around = TOP + TITLES + GAP * across;
      const left = page.sheetLeft(page.byId("splom"));
      const fits = left >= across * LEAST_ON_PAPER + around;
      return Math.max(LEAST_ON_PAPER, Math.min(room, ((fits ? Math.min(490, left) : 490) - around) / across));
    }
    return Math.max(LEAST, Math.min(across === 2 ? 330 : 264, room));
  };

  // Converts values to whole device pixels of a cell; -1 for an absent value.
  const pixelsOf = (column, flip, values = column.values) => {
    const [low, high] = page.wideDomain(column);
    const extent = Math.round(size * ratio);
    const pixels = new Int16Array(values.length);
    for (let i = 0; i < pixels.length; i++) {
      const t = (values[i] - low) / (high - low);
      pixels[i] = t >= 0 && t <= 1 ? Math.round((flip ? 1 - t : t) * (extent - 1)) : -1;
    }
    return pixels;
  };

  // The scales of a cell and what lies behind its points.
  const place = (cell, extent) => {
    cell.behind = layerOf(page.sample, cell.x, cell.y);
    cell.ghost = layerOf(page.ghost, cell.x, cell.y);
    cell.others = page.others.map((other) => ({ other, at: layerOf(other, cell.x, cell.y) })).filter(({ at }) => at);
    cell.ground = cell.behind || cell.ghost || cell.others.length ? cell.ground || new Uint32Array(extent * extent) : null;
    cell.xScale = d3.scaleLinear(page.wideDomain(cell.x), [0, size]);
    cell.yScale = d3.scaleLinear(page.wideDomain(cell.y), [size, 0]);
  };

  // Another front of the same columns: the cells stay, with other points and scales.
  const refresh = () => {
    const { front, state } = page;
    // Without a design the matrix is hidden; the cells stay for the next front.
    if (!front.rows) return;
    const same = cells.length && String(cellNames()) === String(pairs(state.matrix));
    if (!same) return layout();
    const extent = Math.round(size * ratio);
    const pixels = new Map();
    const pixel = (column, flip) => {
      const key = `${flip} ${column.name}`;
      if (!pixels.has(key)) pixels.set(key, pixelsOf(column, flip));
      return pixels.get(key);
    };
    disc = discOf(front.rows);
    for (const cell of cells) {
      [cell.x, cell.y] = [cell.x, cell.y].map((column) => front.byName.get(column.name));
      place(cell, extent);
      [cell.xs, cell.ys] = [pixel(cell.x, false), pixel(cell.y, true)];
      drawAxes(cell);
      cell.marks.selectAll("*").remove();
      addMarks(cell);
    }
    draw(true);
    nameSample();
    syncBrushes();
    showCurrent();
  };

  const cellNames = () => cells.map((cell) => [cell.x.name, cell.y.name]);
  const pairs = (names) => names.flatMap((y, row) => names.slice(0, row).map((x) => [x, y]));

  // The pixels of the sample of feasible designs, of an old front, or of another result in a cell.
  const layerOf = (layer, x, y) => {
    const [across, up] = [x, y].map((column) => layer && layer.byName.get(column.name));
    return across && up ? { xs: pixelsOf(x, false, across.values), ys: pixelsOf(y, true, up.values) } : null;
  };

  const nameSample = () => {
    const { sample } = page;
    const text = page.byId("sample");
    text.hidden = !cells.some((cell) => cell.behind) && !page.stripHas(sample);
    if (text.hidden) return;
    const drawn = sample.rows < sample.of ? `, ${page.count(sample.rows)} drawn` : "";
    text.replaceChildren(page.element("span", { class: "sample-dot", "aria-hidden": "true" }), `${cells.length ? "behind" : "below"} the front: a sample of ${page.count(sample.of)} feasible designs${drawn}`);
  };

  const layout = () => page.keepFocus(page.byId("splom"), build);
  const build = () => {
    const { state, front } = page;
    const box = page.byId("splom");
    const names = state.matrix;
    const hint = page.byId("matrix-hint");
    page.byId("matrix-section").hidden = false;
    cells = [];
    box.replaceChildren();
    page.leaveStrip();
    if (names.length < 2) {
      hint.textContent = names.length ? "Drag to select a range of values. Click near a design to open its card." : "";
      page.drawStrip(box, front.byName.get(names[0]));
      return nameSample();
    }
    hint.textContent = "Drag to select, click a point to open its card; with the keyboard, arrows go from point to point and Enter opens.";
    const width = page.layoutWidth(box);
    const across = names.length - 1;
    size = Math.floor(sizeFor(width, names.length));
    ratio = Math.min(2, window.devicePixelRatio || 1);
    const columns = names.map((name) => front.byName.get(name));
    wordy = columns.every((column) => page.hasRoomForWords(column, titleRoom()));
    const lines = Math.max(...columns.slice(0, -1).map((column) => titleOf(column, 3).lines.length));
    const total = { width: LEFT + across * (size + GAP), height: TOP + across * (size + GAP) - GAP + BOTTOM + 13 * (lines - 1) };
    const extent = Math.round(size * ratio);
    canvas = page.element("canvas", { width: Math.ceil(total.width * ratio), height: Math.ceil(total.height * ratio), "aria-hidden": "true" });
    canvas.style.width = `${canvas.width / ratio}px`;
    canvas.style.height = `${canvas.height / ratio}px`;
    svg = d3.create("svg").attr("width", total.width).attr("height", total.height);
    const xs = columns.map((column) => pixelsOf(column, false));
    const ys = columns.map((column) => pixelsOf(column, true));
    const context = canvas.getContext("2d");
    for (let row = 1; row < names.length; row++)
      for (let at = 0; at < row; at++) {
        const cell = { x: columns[at], y: columns[row], xs: xs[at], ys: ys[row], left: LEFT + at * (size + GAP), top: TOP + (row - 1) * (size + GAP) };
        cell.image = context.createImageData(extent, extent);
        cell.pixels = new Uint32Array(cell.image.data.buffer);
        cell.base = new Uint32Array(extent * extent);
        place(cell, extent);
        addCell(cell, at === 0, row === names.length - 1);
        cells.push(cell);
      }
    dot = page.disc((page.sample && page.sample.rows > 3000 ? 0.7 / ratio : 1.2) * ratio);
    disc = discOf(front.rows);
    const readout = page.element("div", { id: "readout", "data-testid": "readout", tabindex: 0, role: "group", "aria-label": "colours, and the values of the current design" });
    const stage = page.element("div", { class: "stage" }, canvas, svg.node());
    stage.style.width = `${total.width}px`;
    stage.style.height = `${total.height}px`;
    box.append(stage, readout);
    // The upper right of the triangle is free for the colour bar and the values of the current point; where it is too small they are below.
    const free = Math.min(420, width - LEFT - size - GAP - 16);
    const isCorner = across > 1 && size >= 140 && free >= 200 && !page.printing;
    readout.className = isCorner ? "corner" : across > 1 ? "below" : "";
    readout.style.width = isCorner ? `${free}px` : across > 1 ? "100%" : "300px";
    if (isCorner) readout.style.maxHeight = `${size + (across > 2 ? 0 : -4)}px`;
    draw(true);
    nameSample();
    syncBrushes();
    showCurrent();
    page.showReadout();
  };

  const discOf = (rows) => page.disc((rows > 20000 ? 0.7 / ratio : rows > 4000 ? 1.6 : rows > 300 ? 2.4 : 3.4) * ratio);

  const drawAxes = (cell) => {
    const ticks = Math.max(2, Math.floor(size / 62));
    if (cell.xAxis) {
      const draw = (count) => cell.xAxis.call(page.axisOf(d3.axisBottom, cell.x, cell.xScale, count));
      draw(ticks);
      if (cell.x.words) page.tiltWords(cell.xAxis, size / cell.x.words.length);
      // One number is no scale: of more there are two that have room.
      else for (let count = ticks; page.keepTicksApart(cell.xAxis, size) < 2 && count < ticks + 6; count += 2) draw(count + 2);
    }
    if (cell.yAxis) {
      cell.yAxis.call(page.axisOf(d3.axisLeft, cell.y, cell.yScale, ticks));
      if (cell.y.words) page.shortenWords(cell.yAxis, 9);
    }
  };

  // All titles of a matrix say the goals in words, or none does.
  let wordy = false;
  const titleRoom = () => size + GAP - 4;
  const titleOf = (column, most) => page.axisTitle(column, titleRoom(), most, wordy);

  const addCell = (cell, first, last) => {
    const group = svg.append("g").attr("class", "cell").attr("transform", `translate(${cell.left},${cell.top})`);
    group.attr("data-x", cell.x.name).attr("data-y", cell.y.name).attr("tabindex", 0).attr("role", "application");
    group.attr("aria-label", `${page.axisLabel(cell.y)} over ${page.axisLabel(cell.x)}: arrow keys go from design to design, Enter opens the card`);
    group.append("rect").attr("class", "frame").attr("width", size).attr("height", size);
    if (last) {
      cell.xAxis = group.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${size})`);
      page.writeTitle(group.append("text").attr("class", "axis-title").attr("y", size + 37), titleOf(cell.x, 3), size / 2);
    }
    if (first) {
      cell.yAxis = group.append("g").attr("class", "tick-axis");
      const title = titleOf(cell.y, 2);
      page.writeTitle(group.append("text").attr("class", "axis-title").attr("transform", `translate(${title.lines.length > 1 ? -62 : -60},${size / 2})rotate(-90)`), title);
    }
    drawAxes(cell);
    cell.marks = group.append("g").attr("class", "marks");
    cell.brush = d3.brush().extent([[0, 0], [size, size]]).handleSize(7);
    cell.group = group.append("g").attr("class", "brush").call(cell.brush);
    cell.group.select(".overlay").attr("data-testid", `cell ${cell.x.name} ${cell.y.name}`);
    addMarks(cell);
    listen(cell, group);
  };

  // The ideal point (the best value of each objective, which no single design reaches) and the knee.
  const addMarks = (cell) => {
    const { front } = page;
    const ideal = front.ideal || {};
    const clip = (scale, value) => (scale(value) >= 0 && scale(value) <= size ? scale(value) : NaN);
    const [ix, iy] = [clip(cell.xScale, ideal[cell.x.name]), clip(cell.yScale, ideal[cell.y.name])];
    if (Number.isFinite(ix) && Number.isFinite(iy)) {
      const mark = cell.marks.append("path").attr("class", "ideal").attr("d", `M${ix - 6},${iy}h12M${ix},${iy - 6}v12`);
      mark.append("title").text("ideal: the best value of both, which no single design reaches");
    }
    if (cell.xAxis) page.markEnds(cell.marks, cell.x, cell.xScale, (at) => `M${at},${size - 5}v10`, (at, first) => `M${at},${size - 5}l${first ? -8 : 8},5l${first ? 8 : -8},5z`, [0, size]);
    if (cell.yAxis) page.markEnds(cell.marks, cell.y, cell.yScale, (at) => `M-5,${at}h10`, (at, up) => `M-5,${at}l5,${up ? -8 : 8}l5,${up ? 8 : -8}z`, [0, size]);
    const chosen = page.chosenRow();
    if (chosen !== null && chosen !== undefined) {
      const [x, y] = [clip(cell.xScale, cell.x.values[chosen]), clip(cell.yScale, cell.y.values[chosen])];
      if (Number.isFinite(x) && Number.isFinite(y)) cell.marks.append("path").attr("class", "knee").attr("d", `M${x},${y - 6}l6,6l-6,6l-6,-6z`);
    }
    // Bounds of constraints.
    for (const [column, scale, path] of [[cell.x, cell.xScale, (at) => `M${at},0V${size}`], [cell.y, cell.yScale, (at) => `M0,${at}H${size}`]]) {
      for (const limit of page.limitsOf(column)) {
        const at = clip(scale, limit);
        if (Number.isFinite(at)) cell.marks.append("path").attr("class", "limit").attr("d", path(at)).append("title").text(`limit of ${column.name}: ${page.short(limit)}`);
      }
    }
    const pins = page.pins().map((pin) => ({ letter: pin.letter, x: clip(cell.xScale, page.placeIn(pin.values, cell.x)), y: clip(cell.yScale, page.placeIn(pin.values, cell.y)) }));
    page.drawLetters(cell.marks, pins.filter(({ x, y }) => Number.isFinite(x) && Number.isFinite(y)), [0, 0, size, size]);
    cell.interval = cell.marks.append("path").attr("class", "interval");
    cell.current = cell.marks.append("circle").attr("class", "current").attr("r", 6).attr("display", "none");
  };

  const rangeOf = (cell, [[x0, y0], [x1, y1]]) => [
    page.roundRange(cell.xScale.invert(x0), cell.xScale.invert(x1), size, cell.xScale.domain()),
    page.roundRange(cell.yScale.invert(y0), cell.yScale.invert(y1), size, cell.yScale.domain()),
  ];

  const listen = (cell, group) => {
    let from = null;
    const at = (event) => {
      const touch = event.changedTouches ? event.changedTouches[0] : event;
      return d3.pointer(touch, group.node());
    };
    // Of points in the same place, the knee, or the first by weights, is taken if it is one of them.
    const near = ([x, y], reach) => {
      const row = page.nearest(cell.xs, cell.ys, page.mask, x * ratio, y * ratio, reach * ratio);
      const knee = page.chosenRow();
      const onKnee = row >= 0 && page.mask[knee] && cell.xs[row] === cell.xs[knee] && cell.ys[row] === cell.ys[knee];
      return onKnee ? knee : row;
    };
    cell.brush.on("start", (event) => {
      if (event.sourceEvent) from = at(event.sourceEvent);
    });
    cell.brush.on("brush end", (event) => {
      if (!event.sourceEvent) return;
      const moved = Math.hypot(at(event.sourceEvent)[0] - from[0], at(event.sourceEvent)[1] - from[1]);
      if (event.type === "end" && moved < 3) {
        // A click opens the card of the point there; on an empty place it removes the brush.
        const row = near(from, 9);
        if (row < 0 && !event.selection) return page.brushCell(cell.x.name, cell.y.name, null);
        syncBrushes();
        if (row >= 0) page.openCard(row);
        return;
      }
      if (event.selection) page.brushCell(cell.x.name, cell.y.name, ...rangeOf(cell, event.selection));
      else page.brushCell(cell.x.name, cell.y.name, null);
    });
    group.on("pointermove", (event) => {
      const row = event.buttons ? -1 : near(d3.pointer(event, group.node()), 14);
      page.setCurrent(row < 0 ? null : row);
    });
    group.on("pointerleave", () => page.setCurrent(null));
    group.on("keydown", (event) => {
      const steps = { ArrowRight: [cell.x, 1], ArrowLeft: [cell.x, -1], ArrowUp: [cell.y, 1], ArrowDown: [cell.y, -1] };
      const { current } = page.state;
      if (steps[event.key]) page.setCurrent(page.nextInOrder(steps[event.key][0].name, current, steps[event.key][1]));
      else if (event.key === "Enter" && current !== null) page.openCard(current);
      else return;
      page.announce(page.state.current);
      event.preventDefault();
      event.stopPropagation();
    });
  };

  // Brushes follow the state when it was changed elsewhere: by the address, the clear button or typed ranges.
  const syncBrushes = () => {
    for (const cell of cells) {
      const wanted = page.state.cells.get(`${cell.x.name}*${cell.y.name}`);
      const shown = d3.brushSelection(cell.group.node());
      if (!wanted) {
        if (shown) cell.group.call(cell.brush.move, null);
        continue;
      }
      if (shown && String(rangeOf(cell, shown)) === String([wanted.xRange, wanted.yRange])) continue;
      const pair = (scale, range) => range.map((value) => Math.max(0, Math.min(size, scale(value)))).sort((a, b) => a - b);
      const [x0, x1] = pair(cell.xScale, wanted.xRange);
      const [y0, y1] = pair(cell.yScale, wanted.yRange);
      cell.group.call(cell.brush.move, [[x0, y0], [x1, y1]]);
    }
  };

  const fill = (cell, wanted, index) => {
    crowd.clear();
    crowd.addPoints(cell.xs, cell.ys, page.mask, wanted, index);
    return crowd.most;
  };

  // The unselected points of all rows are drawn once per layout, in a pause or with the first brush; a brush then only adds the selected ones.
  const drawUnselected = () => {
    const waiting = cells.filter((it) => !it.isBased);
    if (!waiting.length) return;
    const extent = Math.round(size * ratio);
    const faint = page.pixel(page.variable("--faint"));
    const shades = crowd && page.faintShades();
    for (const cell of waiting) {
      if (crowd) {
        fill(cell, null, null);
        crowd.paint(cell.base, shades, true, densest);
      } else page.drawPoints(cell.base, extent, extent, cell.xs, cell.ys, page.mask, null, faint, disc);
      cell.isBased = true;
    }
  };
  const drawUnselectedLater = page.afterPause(300, () => page.front.rows && drawUnselected());

  // What lies behind the points of the front.
  const drawBehind = (cell, extent, ground) => {
    const points = (at, colour, mark) => page.drawPoints(cell.base, extent, extent, at.xs, at.ys, null, null, page.pixel(colour), mark);
    cell.base.fill(ground);
    if (cell.behind) points(cell.behind, page.variable("--sample"), dot);
    if (cell.ghost) points(cell.ghost, page.variable("--ghost"), disc);
    for (const { other, at } of cell.others) points(at, page.otherColour(other), page.otherMark(other, ratio));
    if (cell.ground) cell.ground.set(cell.base);
    cell.isBased = false;
  };

  const draw = (all) => {
    if (!cells.length) return;
    const start = performance.now();
    const context = canvas.getContext("2d");
    const ground = page.pixel(page.variable("--plot"));
    const extent = Math.round(size * ratio);
    const { index, pixels: colours } = page.paints();
    const everything = page.selectedCount === page.front.rows;
    const order = page.paintOrder();
    if (all) {
      for (const cell of cells) drawBehind(cell, extent, ground);
      crowd = page.isCrowdOfPoints() ? page.crowd(extent, extent) : null;
      densest = crowd && Math.max(...cells.map((cell) => fill(cell, null, null)));
    }
    if (!everything) drawUnselected();
    else if (all) drawUnselectedLater();
    const shades = crowd && page.shades();
    for (const cell of cells) {
      if (everything && cell.ground) cell.pixels.set(cell.ground);
      else if (everything) cell.pixels.fill(ground);
      else cell.pixels.set(cell.base);
      const wanted = everything ? null : 1;
      if (crowd) {
        fill(cell, wanted, index);
        crowd.paint(cell.pixels, shades, true, densest, !everything);
      } else page.drawPoints(cell.pixels, extent, extent, cell.xs, cell.ys, page.mask, wanted, colours, disc, order);
      context.putImageData(cell.image, Math.round(cell.left * ratio), Math.round(cell.top * ratio));
    }
    page.timings.matrixDraw = performance.now() - start;
  };

  const showCurrent = () => {
    const row = page.state.current ?? page.state.card;
    for (const cell of cells) {
      const [x, y] = [cell.xScale(page.currentValue(cell.x.name)), cell.yScale(page.currentValue(cell.y.name))];
      const isWithin = (at) => at >= 0 && at <= size;
      const shown = isWithin(x) && isWithin(y);
      cell.current.attr("display", shown ? null : "none");
      if (shown) cell.current.attr("cx", x).attr("cy", y);
      cell.interval.attr("d", shown && row !== null ? page.intervalPath(row, { ...cell, size }) : null);
    }
  };

  page.startMatrix = () => {
    // With what stands above it of a sample and of other results.
    const boxes = () => ["sample", "others", "splom"].map(page.byId).filter((box) => box && !box.hidden && (box.id !== "others" || page.others.length));
    page.saveButtons(page.byId("matrix-title"), "front", boxes);
    layout();
    page.events.on("columns.matrix", (what) => what === "order" || layout());
    page.events.on("layout.matrix", layout);
    page.events.on("front.matrix", refresh);
    const again = () => {
      for (const cell of cells) {
        cell.marks.selectAll("*").remove();
        addMarks(cell);
      }
      showCurrent();
    };
    page.events.on("pins.matrix", again);
    page.events.on("choice.matrix", () => {
      page.schedule("marks", again);
      page.schedule("matrix", () => draw(false));
    });
    page.events.on("others.matrix", refresh);
    page.events.on("theme.matrix", () => draw(true));
    page.events.on("colour.matrix", () => page.schedule("matrix", () => draw(false)));
    page.events.on("selection.matrix", () => {
      syncBrushes();
      page.schedule("matrix", () => draw(false));
    });
    page.events.on("current.matrix", showCurrent);
    page.events.on("card.matrix", showCurrent);
  };
}
