// A sheet to draw on: lengths in millimetres become an SVG with labels, dimensions and a scale bar. y points up, as in a drawing.
{
  const WIDTH = 400; // units of the SVG, px where the card is as wide as usual
  const MOST_HIGH = 420;
  const FONT = 11;
  let sheets = 0;

  // The roundest length, 1, 2 or 5 times a power of ten, that is no longer than this.
  const roundLength = (most) => {
    const power = 10 ** Math.floor(Math.log10(most));
    return [5, 2, 1].map((it) => it * power).find((it) => it <= most) ?? power;
  };

  // `bounds` in mm: left, right, top, bottom; `room` in px around them.
  page.sheetOf = (bounds, room, { title, description }) => {
    const across = WIDTH - room.left - room.right;
    const scale = Math.min(across / (bounds.right - bounds.left), MOST_HIGH / (bounds.top - bounds.bottom));
    const left = room.left + (across - scale * (bounds.right - bounds.left)) / 2;
    const height = Math.ceil(room.top + scale * (bounds.top - bounds.bottom) + room.bottom);
    const x = (mm) => left + scale * (mm - bounds.left);
    const y = (mm) => room.top + scale * (bounds.top - mm);
    const id = `drive-${sheets++}`;
    const svg = d3.create("svg").attr("class", "drive").attr("viewBox", `0 0 ${WIDTH} ${height}`).attr("width", WIDTH).attr("height", height).attr("role", "img").attr("aria-labelledby", `${id}-title ${id}-text`);
    svg.append("title").attr("id", `${id}-title`).text(title);
    svg.append("desc").attr("id", `${id}-text`).text(description);

    const path = (points, closed = true) => `M${points.map(([px, py]) => `${x(px).toFixed(2)},${y(py).toFixed(2)}`).join("L")}${closed ? "Z" : ""}`;
    const shape = (kind, d) => svg.append("path").attr("class", kind).attr("d", d);
    const text = (px, py, words, anchor = "middle") => svg.append("text").attr("x", px).attr("y", py).attr("text-anchor", anchor).attr("font-size", FONT).text(words);

    // An arrow head at a place of the paper, which points along (dx, dy).
    const head = (px, py, dx, dy) => `M${px - 6 * dx + 2.2 * dy},${py - 6 * dy - 2.2 * dx}L${px},${py}L${px - 6 * dx - 2.2 * dy},${py - 6 * dy + 2.2 * dx}`;
    const sheet = {
      svg,
      scale,
      x,
      y,
      height,
      node: () => svg.node(),
      polygon: (kind, points, closed = true) => shape(kind, path(points, closed)),
      // Several closed lines of which the area between them is meant.
      between: (kind, ...lines) => shape(kind, lines.map((line) => path(line)).join("")).attr("fill-rule", "evenodd"),
      circle: (kind, cx, cy, radius) => svg.append("circle").attr("class", kind).attr("cx", x(cx)).attr("cy", y(cy)).attr("r", scale * radius),
      line: (kind, from, to) => shape(kind, path([from, to], false)),
      label: (at, words, [dx, dy] = [0, 0], anchor = "middle") => text(x(at[0]) + dx, y(at[1]) + dy, words, anchor),
      // A distance between two places of one height, `down` px below them; lines lead to it.
      across: (from, to, down, words) => {
        const [a, b, py] = [x(from[0]), x(to[0]), Math.max(y(from[1]), y(to[1])) + down];
        shape("measure", `M${a},${y(from[1]) + 3}V${py + 4}M${b},${y(to[1]) + 3}V${py + 4}M${a},${py}H${b}${head(a, py, -1, 0)}${head(b, py, 1, 0)}`);
        // What is too short for its words has them beside it.
        const inside = words.length * 5.8 + 16 < b - a;
        return inside ? text((a + b) / 2, py - 4, words) : text(b + 6, py + 4, words, "start");
      },
      // A distance between two places of one column, `right` px beside them.
      upright: (from, to, right, words) => {
        const [a, b, px] = [y(from[1]), y(to[1]), Math.max(x(from[0]), x(to[0])) + right];
        shape("measure", `M${x(from[0]) + 3},${a}H${px + 4}M${x(to[0]) + 3},${b}H${px + 4}M${px},${a}V${b}${head(px, a, 0, Math.sign(a - b))}${head(px, b, 0, Math.sign(b - a))}`);
        return text(px + 5, (a + b) / 2 + 4, words, "start");
      },
      // A radius, drawn from its centre at an angle in degrees, with its words beyond the arrow.
      radius: (cx, cy, radius, angle, words) => {
        const [dx, dy] = [Math.cos((angle * Math.PI) / 180), -Math.sin((angle * Math.PI) / 180)];
        const [ax, ay] = [x(cx), y(cy)];
        const [bx, by] = [ax + scale * radius * dx, ay + scale * radius * dy];
        shape("measure", `M${ax},${ay}L${bx},${by}${head(bx, by, dx, dy)}`);
        return words ? text(bx + 6 * dx, by + 6 * dy + (dy > 0.3 ? 9 : 3), words, Math.abs(dx) < 0.3 ? "middle" : dx > 0 ? "start" : "end") : null;
      },
      // An angle between two directions about a place, in degrees from the right upwards.
      angle: (at, reach, from, to, words) => {
        const place = (angle, r) => [x(at[0]) + r * Math.cos((angle * Math.PI) / 180), y(at[1]) - r * Math.sin((angle * Math.PI) / 180)];
        const points = d3.range(0, 1.0001, 1 / 48).map((part) => place(from + part * (to - from), reach));
        shape("measure", `M${points.map((it) => it.join(",")).join("L")}`);
        const [px, py] = place((from + to) / 2, reach + 5);
        return words ? text(px, py + 4, words, "middle") : null;
      },
      // Words in the right corner.
      foot: (words) => text(WIDTH - 8, height - 5, words, "end"),
      // In the left corner: a length as a bar. Whatever is printed larger or smaller says by it what it measures.
      bar: () => {
        const length = roundLength(WIDTH / 3.5 / scale);
        const [px, py] = [8, height - 8];
        shape("scale-bar", `M${px},${py - 4}V${py + 2}M${px},${py}H${px + scale * length}M${px + scale * length},${py - 4}V${py + 2}`);
        return text(px + scale * length + 6, py + 3, length >= 1000 ? `${length / 1000} m` : `${length} mm`, "start").attr("class", "scale-text");
      },
    };
    return sheet;
  };
}
