// The lines of the parallel coordinates, drawn in slices of a few milliseconds, so that a hundred thousand of them never
// delay a brush. Rows are taken in a shuffled order, so the first slice is a sample of all of them.
{
  const SLICE = 12; // ms of a frame
  const CHUNK = 200; // lines between two looks at the clock
  let plot = null; // { canvas, context, image, pixels, base, xs, ys, width, height }
  let order = null;
  let run = 0; // each new drawing stops the one before

  const shuffled = (count) => {
    const rows = Uint32Array.from({ length: count }, (_, i) => i);
    const random = d3.randomLcg(0.5);
    for (let i = count - 1; i > 0; i--) {
      const j = Math.floor(random() * (i + 1));
      [rows[i], rows[j]] = [rows[j], rows[i]];
    }
    return rows;
  };

  page.layoutLines = (layout) => {
    run++;
    plot = null;
    if (!layout) return;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    const { canvas, axes } = layout;
    const width = Math.round(layout.width * ratio);
    const height = Math.round(layout.height * ratio);
    canvas.width = width;
    canvas.height = height;
    canvas.style.width = `${width / ratio}px`;
    canvas.style.height = `${height / ratio}px`;
    const context = canvas.getContext("2d");
    const image = context.createImageData(width, height);
    const ys = axes.map(({ column, scale }) => {
      const [low, high] = scale.domain();
      const [from, to] = scale.range();
      const factor = ((to - from) / (high - low)) * ratio;
      return Float32Array.from(column.values, (value) => (value - low) * factor + from * ratio);
    });
    plot = { context, image, width, height, ys, pixels: new Uint32Array(image.data.buffer), base: new Uint32Array(width * height) };
    plot.xs = axes.map((axis) => axis.x * ratio);
    plot.baseDone = 0; // how many unselected lines are in the base already
    page.redrawLines("all");
  };

  // Each line can be told from the ground; of a crowd, where lines lie over one another, the more the fainter each.
  const CROWD = 3000;
  const coverFor = (count) => (count <= CROWD ? 256 : Math.round(256 * Math.max(0.1, Math.min(0.9, 22 / Math.sqrt(count)))));

  // Few lines are drawn so soon that the best can come last; of many the first slice is to be a sample.
  const MOST_ORDERED = 4000;
  const ordered = () => {
    const { rows } = page.front;
    const best = rows <= MOST_ORDERED ? page.paintOrder() : null;
    return best ?? (order && order.length === rows ? order : shuffled(rows));
  };

  page.redrawLines = (what) => {
    if (!plot) return;
    order = ordered();
    const mine = ++run;
    if (what === "all") {
      plot.base.fill(page.pixel(page.variable("--plot")));
      plot.baseDone = 0;
    }
    const everything = page.selectedCount === page.front.rows;
    const rows = everything ? order : order.filter((row) => page.mask[row]);
    const faint = page.pixel(page.variable("--faint"));
    const faintCover = coverFor(page.front.rows);
    const cover = coverFor(rows.length);
    const colours = page.colours();
    const { width, height, xs, ys } = plot;
    let done = 0;
    const restart = () => {
      if (everything) plot.pixels.fill(page.pixel(page.variable("--plot")));
      else plot.pixels.set(plot.base);
      done = 0;
    };
    // All lines are drawn, faint, below those of a selection, once per layout. Until they are complete, each slice draws
    // the selected ones over them again, at first a sample of them.
    const drawUnder = (over) => {
      while (plot.baseDone < order.length && !over()) {
        const to = Math.min(order.length, plot.baseDone + CHUNK);
        page.drawLines(plot.base, width, height, order, plot.baseDone, to, xs, ys, faint, faintCover);
        plot.baseDone = to;
      }
      restart();
    };
    const slice = () => {
      if (mine !== run || !plot) return;
      const start = performance.now();
      const over = () => !page.printing && performance.now() - start > SLICE;
      const under = () => !everything && plot.baseDone < order.length;
      if (under()) drawUnder(over);
      else if (!done) restart();
      while (done < rows.length && (!over() || done === 0)) {
        const to = Math.min(rows.length, done + CHUNK);
        page.drawLines(plot.pixels, width, height, rows, done, to, xs, ys, colours, cover);
        done = to;
      }
      if (under()) done = 0;
      plot.context.putImageData(plot.image, 0, 0);
      page.timings.linesSlice = performance.now() - start;
      if (done < rows.length || under()) again();
      else page.timings.linesDone = performance.now();
    };
    const again = () => (page.printing ? slice() : requestAnimationFrame(slice));
    again();
  };
}
