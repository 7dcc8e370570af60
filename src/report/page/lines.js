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
    const crowdOf = (count) => (page.isCrowdOfLines(count) ? page.crowd(width, height) : null);
    [plot.crowd, plot.crowdBehind] = [crowdOf(page.front.rows), crowdOf(page.front.rows)];
    plot.finish = 0; // ms that bringing a slice to the screen took
    page.redrawLines("all");
  };

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
      plot.crowdBehind?.clear();
      plot.baseDone = 0;
    }
    const everything = page.selectedCount === page.front.rows;
    const rows = everything ? order : order.filter((row) => page.mask[row]);
    const faint = page.pixel(page.variable("--faint"));
    const colours = page.colours();
    const { index } = page.paints();
    const { width, height, xs, ys, crowdBehind } = plot;
    // Each of few lines has its colour; of a crowd, the more lie in one place the more its colour differs from the ground.
    const crowd = page.isCrowdOfLines(rows.length) ? plot.crowd : null;
    const shades = crowd && page.shades();
    let done = 0;
    const restart = () => {
      if (everything) plot.pixels.fill(page.pixel(page.variable("--plot")));
      else plot.pixels.set(plot.base);
      crowd?.clear();
      done = 0;
    };
    // All lines are drawn, faint, below those of a selection, once per layout. Until they are complete, each slice draws
    // the selected ones over them again, at first a sample of them.
    const drawUnder = (over) => {
      while (plot.baseDone < order.length && !over()) {
        const to = Math.min(order.length, plot.baseDone + CHUNK);
        if (crowdBehind) crowdBehind.addLines(order, plot.baseDone, to, xs, ys, null);
        else page.drawLines(plot.base, width, height, order, plot.baseDone, to, xs, ys, faint);
        plot.baseDone = to;
      }
      crowdBehind?.paint(plot.base, page.faintShades(), false);
      restart();
    };
    const slice = () => {
      if (mine !== run || !plot) return;
      const start = performance.now();
      const over = () => !page.printing && performance.now() - start > SLICE - plot.finish;
      const under = () => !everything && plot.baseDone < order.length;
      if (under()) drawUnder(over);
      else if (!done) restart();
      while (done < rows.length && (!over() || done === 0)) {
        const to = Math.min(rows.length, done + CHUNK);
        if (crowd) crowd.addLines(rows, done, to, xs, ys, index);
        else page.drawLines(plot.pixels, width, height, rows, done, to, xs, ys, colours);
        done = to;
      }
      if (under()) done = 0;
      const drawn = performance.now();
      crowd?.paint(plot.pixels, shades, false, crowd.most, !everything);
      plot.context.putImageData(plot.image, 0, 0);
      plot.finish = Math.min(SLICE / 2, performance.now() - drawn);
      page.timings.linesSlice = performance.now() - start;
      if (done < rows.length || under()) again();
      else page.timings.linesDone = performance.now();
    };
    const again = () => (page.printing ? slice() : requestAnimationFrame(slice));
    again();
  };
}
