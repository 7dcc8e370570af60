// Maps: the best feasible value over two inputs, cell by cell on a canvas, with contours drawn over it.
{
  const WIDTH = 680;
  const HEIGHT = 440;
  const NO_DESIGN = 2n ** 64n - 1n;
  const MARGIN = { left: 74, right: 30, top: 10, bottom: 50 };

  // The border of two cells is halfway between their values, on a log axis halfway between the logs; words are one step apart.
  const edgesOf = (values, log) => {
    if (typeof values[0] === "string") return d3.range(values.length + 1).map((i) => i - 0.5);
    const f = log ? Math.log : (v) => v;
    const g = log ? Math.exp : (v) => v;
    if (values.length === 1) return [g(f(values[0]) - 0.5), g(f(values[0]) + 0.5)];
    const inner = d3.range(1, values.length).map((i) => g((f(values[i - 1]) + f(values[i])) / 2));
    const last = values.length - 1;
    const before = g(f(values[0]) - (f(values[1]) - f(values[0])) / 2);
    const after = g(f(values[last]) + (f(values[last]) - f(values[last - 1])) / 2);
    return [before, ...inner, after];
  };

  const scaleFor = (axis, log, range) => {
    const words = typeof axis.values[0] === "string";
    const edges = edgesOf(axis.values, log && !words);
    const scale = (log && !words ? d3.scaleLog : d3.scaleLinear)([edges[0], edges[edges.length - 1]], range);
    return { scale, edges, words };
  };

  const ticksFor = (orient, axis, { scale, words }, count) => {
    const ticks = orient(scale).tickSizeOuter(0).tickSize(4);
    if (words) return ticks.tickValues(d3.range(axis.values.length)).tickFormat((i) => axis.values[i]);
    return ticks.ticks(count).tickFormat(scale.base ? scale.tickFormat(count, "~g") : page.tick(scale, count));
  };

  // Which cell each pixel shows, once per row and column of pixels.
  const cellsOf = ({ scale, edges }, pixels, from) =>
    Int32Array.from({ length: pixels }, (_, i) => Math.max(0, Math.min(edges.length - 2, d3.bisectRight(edges, scale.invert(from + i + 0.5)) - 1)));

  const fill = (canvas, values, columns, xCells, yCells, low, high) => {
    const context = canvas.getContext("2d");
    const image = context.createImageData(canvas.width, canvas.height);
    const pixels = new Uint32Array(image.data.buffer);
    const table = page.rampPixels(page.areaRamp());
    // Hatched, as no colour of the scale could be told from the ground with certainty.
    const [ground, stroke] = ["--absent", "--muted"].map((name) => page.pixel(page.variable(name)));
    const none = (x, y) => ((x + y) % 7 < 1 ? stroke : ground);
    const span = high - low;
    for (let y = 0; y < canvas.height; y++)
      for (let x = 0; x < canvas.width; x++) {
        const value = values[yCells[y] * columns + xCells[x]];
        const t = span > 0 ? (value - low) / span : 0.5;
        pixels[y * canvas.width + x] = Number.isNaN(value) ? none(x, y) : table[Math.round(255 * Math.max(0, Math.min(1, t)))];
      }
    context.putImageData(image, 0, 0);
  };

  // On white; so is the casing of each line, which keeps it apart from the colours of the cells.
  const contourColours = ["#d55e00", "#000000", "#c46a9c", "#0072b2"];
  page.contourColours = contourColours;

  const drawContours = (svg, map, x, y) => {
    const labels = []; // where the labels are, so that none covers another
    const free = ([x, y]) => labels.every(([a, b]) => Math.hypot(a - x, b - y) > 24);
    const kinds = [...new Set(map.contours.map((contour) => contour.of))];
    for (const contour of map.contours) {
      const group = svg.append("g").attr("class", "contour").attr("stroke", contourColours[kinds.indexOf(contour.of) % contourColours.length]);
      let longest = null;
      for (const line of contour.lines) {
        const points = d3.range(0, line.length - 1, 2).map((i) => [x.scale(line[i]), y.scale(line[i + 1])]);
        const path = d3.line()(points);
        group.append("path").attr("class", "casing").attr("d", path);
        group.append("path").attr("d", path);
        if (!longest || points.length > longest.length) longest = points;
      }
      const place = longest && [0.5, 0.35, 0.65, 0.2, 0.8].map((part) => longest[Math.floor(longest.length * part)]).find(free);
      if (place && longest.length > 3) {
        labels.push(place);
        const [tx, ty] = place;
        svg.append("text").attr("class", "contour-label").attr("x", tx).attr("y", ty + 3).attr("text-anchor", "middle").text(page.short(contour.at));
      }
    }
    return kinds.map((kind, i) => {
      const stroke = page.element("span", { class: "stroke" });
      stroke.style.background = contourColours[i % contourColours.length];
      const at = map.contours.filter((contour) => contour.of === kind).map((contour) => page.short(contour.at));
      const nowhere = map.contours.filter((contour) => contour.of === kind && !contour.lines.length).map((contour) => page.short(contour.at));
      const lost = nowhere.length ? ` (not reached: ${nowhere.join(", ")})` : "";
      return page.element("span", { class: "word" }, stroke, `${kind} at ${at.length > 8 ? `${at.slice(0, 3).join(", ")} … ${at[at.length - 1]}` : at.join(", ")}${lost}`);
    });
  };

  const drawCells = (figure, map, values, indices) => {
    const inner = { width: WIDTH - MARGIN.left - MARGIN.right, height: HEIGHT - MARGIN.top - MARGIN.bottom };
    const [logX, logY] = map.log || [false, false];
    const x = scaleFor(map.x, logX, [MARGIN.left, WIDTH - MARGIN.right]);
    const y = scaleFor(map.y, logY, [HEIGHT - MARGIN.bottom, MARGIN.top]);
    const xCells = cellsOf(x, inner.width, MARGIN.left);
    const yCells = cellsOf(y, inner.height, MARGIN.top);
    const columns = map.x.values.length;
    let [low, high] = d3.extent(values);
    if (map.best === "share") [low, high] = [0, Math.max(high ?? 0, 0)];
    const canvas = page.element("canvas", { width: inner.width, height: inner.height, role: "img", "aria-label": `Map of ${map.value.name} over ${map.x.name} and ${map.y.name}` });
    canvas.style.left = `${(100 * MARGIN.left) / WIDTH}%`;
    canvas.style.top = `${(100 * MARGIN.top) / HEIGHT}%`;
    canvas.style.width = `${(100 * inner.width) / WIDTH}%`;
    canvas.style.height = `${(100 * inner.height) / HEIGHT}%`;
    const svg = d3.create("svg").attr("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
    const readout = page.element("p", { class: "map-readout" }, "\u00a0");
    const legend = page.element("div", { class: "map-legend" });
    const paint = () => {
      fill(canvas, values, columns, xCells, yCells, low, high);
      legend.replaceChildren(page.colourBar(page.axisName(map.value.name, map.value.unit), low, high, page.areaRamp(), 260), ...lines);
    };
    svg.append("rect").attr("class", "frame").attr("x", MARGIN.left).attr("y", MARGIN.top).attr("width", inner.width).attr("height", inner.height);
    svg.append("g").attr("class", "tick-axis").attr("transform", `translate(0,${HEIGHT - MARGIN.bottom})`).call(ticksFor(d3.axisBottom, map.x, x, 7));
    const left = svg.append("g").attr("class", "tick-axis").attr("transform", `translate(${MARGIN.left},0)`).call(ticksFor(d3.axisLeft, map.y, y, 6));
    if (y.words) page.shortenWords(left, 9);
    svg.append("text").attr("class", "axis-title").attr("x", MARGIN.left + inner.width / 2).attr("y", HEIGHT - 10).attr("text-anchor", "middle").text(page.axisName(map.x.name, map.x.unit));
    svg.append("text").attr("class", "axis-title").attr("transform", `translate(14,${MARGIN.top + inner.height / 2})rotate(-90)`).attr("text-anchor", "middle").text(page.axisName(map.y.name, map.y.unit));
    const lines = map.contours && map.contours.length ? drawContours(svg, map, x, y) : [];
    const marker = svg.append("rect").attr("class", "map-cell").attr("display", "none");
    const show = (column, row) => {
      const at = row * columns + column;
      const part = (name, value, unit) => `${name} ${page.short(value)}${unit ? ` ${page.unit(unit)}` : ""}`;
      const value = Number.isNaN(values[at]) ? "no feasible design" : part(map.value.name, values[at], map.value.unit);
      const design = indices && indices[at] !== NO_DESIGN ? `, best design ${indices[at]}` : "";
      readout.textContent = `${part(map.x.name, map.x.values[column], map.x.unit)}, ${part(map.y.name, map.y.values[row], map.y.unit)}: ${value}${design}`;
      const [x0, x1] = [x.scale(x.edges[column]), x.scale(x.edges[column + 1])];
      const [y0, y1] = [y.scale(y.edges[row + 1]), y.scale(y.edges[row])];
      marker.attr("display", null).attr("x", x0).attr("y", y0).attr("width", x1 - x0).attr("height", y1 - y0);
    };
    let place = [0, 0];
    const stage = page.element("div", { class: "map-stage", tabindex: 0, role: "application", "aria-label": `Map of ${map.value.name}: arrow keys go from cell to cell` }, canvas, svg.node());
    svg.on("pointermove", (event) => {
      const [px, py] = d3.pointer(event, svg.node());
      const [i, j] = [Math.floor(px - MARGIN.left), Math.floor(py - MARGIN.top)];
      if (i < 0 || j < 0 || i >= inner.width || j >= inner.height) return hide();
      place = [xCells[i], yCells[j]];
      show(...place);
    });
    const hide = () => {
      marker.attr("display", "none");
      readout.textContent = "\u00a0";
    };
    svg.on("pointerleave", hide);
    const open = ([column, row]) => {
      const at = row * columns + column;
      const design = indices ? indices[at] : NO_DESIGN;
      if (design === NO_DESIGN || Number.isNaN(values[at])) return;
      page.openDesign(String(design), [{ ...map.value, value: values[at] }]);
    };
    if (indices) svg.on("click", () => marker.attr("display") !== "none" && open(place)).classed("opens-card", true);
    stage.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && indices) return open(place);
      const move = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!move) return;
      event.preventDefault();
      place = [Math.max(0, Math.min(columns - 1, place[0] + move[0])), Math.max(0, Math.min(map.y.values.length - 1, place[1] + move[1]))];
      show(...place);
    });
    // The current design and those that are pinned, where the map is over inputs that are chosen.
    const designs = svg.append("g").attr("class", "marks");
    const placeOf = (of) => {
      const place = [[x, of(map.x.name)], [y, of(map.y.name)]].map(([axis, value]) => (typeof value === "number" ? axis.scale(value) : NaN));
      return place.every(Number.isFinite) ? place : null;
    };
    const mark = () => {
      designs.selectAll("*").remove();
      const pins = page.pins().map((pin) => {
        const place = placeOf((name) => (pin.values.get(name)?.role === "design" && !pin.values.get(name).words ? pin.values.get(name).value : null));
        return place && { letter: pin.letter, x: place[0], y: place[1] };
      });
      page.drawLetters(designs, pins.filter(Boolean), [MARGIN.left, MARGIN.top, WIDTH - MARGIN.right, HEIGHT - MARGIN.bottom]);
      const isChosen = (name) => page.front?.byName.get(name)?.role === "design" && !page.front.byName.get(name).words;
      const current = placeOf((name) => (isChosen(name) ? page.currentValue(name) : null));
      if (current) designs.append("circle").attr("class", "current").attr("r", 6).attr("cx", current[0]).attr("cy", current[1]);
    };
    for (const event of ["current", "card", "pins"]) page.events.on(`${event}.map${figure.dataset.map}`, mark);
    readout.setAttribute("aria-live", "polite");
    const plate = page.element("div", { class: "map-plate" }, legend, stage);
    figure.querySelector(".title-line").append(page.saveButtonsOf(`the map of ${map.value.name}`, `map-${map.value.name}`, () => plate));
    figure.append(plate, readout);
    paint();
    mark();
    page.events.on(`theme.map${figure.dataset.map}`, paint);
  };

  const figureOf = (map, number) => {
    const best = { min: "the least of the feasible designs", max: "the largest of the feasible designs", share: "the share of designs that are feasible" }[map.best] || "";
    const others = (page.data.inputs || []).some(({ name, role }) => role === "design" && name !== map.x.name && name !== map.y.name);
    const caption = page.element("figcaption", {}, page.element("div", { class: "title-line" }, page.element("strong", {}, map.title || `${map.value.name} over ${map.x.name} and ${map.y.name}`)), map.value.doc ? ` ${map.value.doc}` : "", page.element("div", { class: "muted" }, `In each cell ${best}${others ? " over all other inputs" : ""}. Hatched: no feasible design.${map.cells && map.cells.indices && page.data.study?.feasible !== 0 ? " A click opens the design of a cell." : ""}`));
    return page.element("figure", { class: "figure map", "data-map": number, "data-testid": `map-${map.value.name}` }, caption);
  };

  page.startMaps = async () => {
    const { maps } = page.data;
    if (!maps || !maps.length) return;
    const section = page.byId("maps");
    section.hidden = false;
    const figures = maps.map(figureOf);
    section.append(page.element("h2", { id: "maps-title" }, maps.length > 1 ? "Maps" : "Map"), page.element("div", { class: "figures" }, figures));
    for (const [i, map] of maps.entries()) {
      if (map.cells) {
        const numbers = await page.inflate(map.cells.packed);
        const count = map.x.values.length * map.y.values.length;
        drawCells(figures[i], map, new Float64Array(numbers, 0, count), map.cells.indices ? new BigUint64Array(numbers, 8 * count, count) : null);
      } else if (map.picture) {
        const picture = page.picture(map.picture, `Map of ${map.value.name} over ${map.x.name} and ${map.y.name}`);
        figures[i].querySelector(".title-line").append(page.saveButtonsOf(`the map of ${map.value.name}`, `map-${map.value.name}`, () => picture));
        figures[i].append(picture);
      }
      if (map.stripes) figures[i].append(page.element("p", { class: "notice", "data-testid": "stripes" }, map.stripes));
    }
  };
}
