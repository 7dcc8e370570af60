// Points and lines drawn into the pixels of an ImageData. Without a GPU this is many times faster than canvas paths,
// and as fast in every browser.
{
  // A disc as offsets with their coverage of 0 to 256.
  page.disc = (radius) => {
    // Many points: two by two pixels, without mixing.
    if (radius < 1) return [[0, 0], [1, 0], [0, 1], [1, 1]].map(([dx, dy]) => ({ dx, dy, cover: 256 }));
    const reach = Math.ceil(radius);
    const spots = [];
    for (let dy = -reach; dy <= reach; dy++)
      for (let dx = -reach; dx <= reach; dx++) {
        const cover = Math.max(0, Math.min(1, radius + 0.5 - Math.hypot(dx, dy)));
        if (cover > 0.04) spots.push({ dx, dy, cover: Math.round(cover * 256) });
      }
    return spots;
  };

  // Red and blue are mixed together, then green: two multiplications per pixel.
  const mix = (under, over, cover) => {
    const rest = 256 - cover;
    const rb = (((under & 0xff00ff) * rest + (over & 0xff00ff) * cover) >>> 8) & 0xff00ff;
    const g = (((under & 0x00ff00) * rest + (over & 0x00ff00) * cover) >>> 8) & 0x00ff00;
    return (0xff000000 | rb | g) >>> 0;
  };

  // Points with mask[row] === wanted (all for wanted null); xs and ys hold pixels, negative for an absent value. `order`: the rows,
  // those that lie over the others last; each is painted whole before the next one.
  page.drawPoints = (target, width, height, xs, ys, mask, wanted, colourOf, disc, order = null) => {
    const single = typeof colourOf === "number";
    const offsets = disc.map(({ dx, dy }) => dy * width + dx);
    const reach = Math.max(...disc.flatMap(({ dx, dy }) => [Math.abs(dx), Math.abs(dy)]));
    // Without an order the first rows, which are the best of the first objective, are painted last.
    for (let k = xs.length - 1; k >= 0; k--) {
      const i = order ? order[xs.length - 1 - k] : k;
      if (wanted !== null && mask[i] !== wanted) continue;
      const x = xs[i];
      const y = ys[i];
      if (x < 0 || y < 0) continue;
      const isInside = x >= reach && y >= reach && x < width - reach && y < height - reach;
      const colour = single ? colourOf : colourOf[i];
      for (let spot = 0; spot < offsets.length; spot++) {
        const { dx, dy, cover } = disc[spot];
        if (!isInside && (x + dx < 0 || y + dy < 0 || x + dx >= width || y + dy >= height)) continue;
        const at = y * width + x + offsets[spot];
        target[at] = cover >= 256 ? colour : mix(target[at], colour, cover);
      }
    }
  };

  // One straight line with smooth edges (Wu): along the longer direction, two pixels per step share the coverage.
  const drawLine = (target, width, height, x0, y0, x1, y1, colour) => {
    const steep = Math.abs(y1 - y0) > Math.abs(x1 - x0);
    if (steep) [x0, y0, x1, y1] = [y0, x0, y1, x1];
    if (x0 > x1) [x0, y0, x1, y1] = [x1, y1, x0, y0];
    const slope = x1 > x0 ? (y1 - y0) / (x1 - x0) : 0;
    const along = steep ? width : 1;
    const across = steep ? 1 : width;
    const limit = (steep ? width : height) - 1;
    const end = Math.min(Math.round(x1), (steep ? height : width) - 1);
    let a = Math.max(0, Math.round(x0));
    let b = y0 + (a - x0) * slope;
    for (; a <= end; a++, b += slope) {
      const whole = Math.floor(b);
      if (whole < 0 || whole >= limit) continue;
      const part = b - whole;
      const at = a * along + whole * across;
      const lower = (256 * part) | 0;
      target[at] = mix(target[at], colour, 256 - lower);
      target[at + across] = mix(target[at + across], colour, lower);
    }
  };

  // Polylines over the axes at xs for rows[from..to); ys[axis][row] in pixels, NaN breaks the line.
  page.drawLines = (target, width, height, rows, from, to, xs, ys, colourOf) => {
    const single = typeof colourOf === "number";
    for (let i = from; i < to; i++) {
      const row = rows[i];
      const colour = single ? colourOf : colourOf[row];
      for (let axis = 1; axis < xs.length; axis++) {
        const y0 = ys[axis - 1][row];
        const y1 = ys[axis][row];
        if (y0 >= 0 && y1 >= 0) drawLine(target, width, height, xs[axis - 1], y0, xs[axis], y1, colour);
      }
    }
  };

  // The nearest wanted point to a pixel, or -1.
  page.nearest = (xs, ys, mask, x, y, reach) => {
    let best = -1;
    let least = reach * reach;
    for (let i = 0; i < xs.length; i++) {
      if (!mask[i] || xs[i] < 0 || ys[i] < 0) continue;
      const d = (xs[i] - x) ** 2 + (ys[i] - y) ** 2;
      if (d <= least) {
        least = d;
        best = i;
      }
    }
    return best;
  };
}
