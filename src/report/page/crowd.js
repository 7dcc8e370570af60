// Crowds: where many points or lines lie in one place, only the last of them is seen. How many they are is told by the lightness of its
// colour, whose hue stays, so that it still tells the column. What lies alone has a contrast of 3 to the ground already.
{
  const LEVELS = 16;
  const ALONE = 3.2; // contrast to the ground, with room for rounding
  const DENSEST = 9; // at least; a colour that has more itself keeps that
  const DENSEST_FAINT = 4.4; // of what is not selected, which stays behind the rest
  const SELECTED = 0.35; // the part of the levels that a selection leaves to what lies behind it
  const MANY = 4096; // more in one place are shown as this many
  const MOST_POINTS = 20000;
  const MOST_LINES = 3000;

  page.isCrowdOfPoints = () => page.front.rows > MOST_POINTS;
  page.isCrowdOfLines = (count) => count > MOST_LINES;

  page.denser = () => (page.dark() ? "Brighter" : "Darker");

  const luminance = (colour) => {
    const { r, g, b } = d3.rgb(colour);
    const part = (value) => (value <= 10 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4);
    return 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  };
  page.contrast = (one, other) => {
    const [a, b] = [luminance(one), luminance(other)];
    return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  };

  // A colour at another lightness, as the screen can show it.
  const lit = ({ h, c }, l) => d3.rgb(d3.hcl(h, c, l)).clamp();

  // The lightness nearest to that of the ground at which a hue has this contrast to it.
  const lightnessFor = (colour, ground, contrast) => {
    let near = d3.hcl(ground).l;
    let far = page.dark() ? 100 : 0;
    for (let step = 0; step < 12; step++) {
      const middle = (near + far) / 2;
      if (page.contrast(lit(colour, middle), ground) < contrast) near = middle;
      else far = middle;
    }
    return far;
  };

  // Each colour at all levels, the one of what lies alone first.
  const shadesOf = (colours, densest) => {
    const ground = page.variable("--plot");
    const shades = new Uint32Array(colours.length * LEVELS);
    colours.forEach((text, at) => {
      const colour = d3.hcl(text);
      const alone = lightnessFor(colour, ground, ALONE);
      const dense = lightnessFor(colour, ground, Math.max(densest, page.contrast(text, ground)));
      for (let level = 0; level < LEVELS; level++) shades[at * LEVELS + level] = page.pixel(lit(colour, alone + ((dense - alone) * level) / (LEVELS - 1)));
    });
    return shades;
  };
  let known = { palette: null, shades: null };
  page.shades = () => {
    const { palette } = page.paints();
    if (known.palette !== palette) known = { palette, shades: shadesOf(palette, DENSEST) };
    return known.shades;
  };
  page.faintShades = () => shadesOf([page.variable("--faint")], DENSEST_FAINT);

  // The level of each count, on a scale of logarithms up to `most`.
  const levelsOf = (most, above) => {
    const last = Math.min(most, MANY);
    const whole = Math.log(Math.max(2, last));
    return Uint8Array.from({ length: last + 1 }, (_, count) => Math.round((LEVELS - 1) * (above + (1 - above) * (Math.log(Math.max(1, count)) / whole))));
  };

  // How many lie in each pixel, and which colour of the palette the last of them has.
  page.crowd = (width, height) => {
    const counts = new Uint32Array(width * height);
    const colours = new Uint16Array(width * height);
    let most = 0;
    const put = (at, colour) => {
      const count = ++counts[at];
      colours[at] = colour;
      if (count > most) most = count;
    };
    return {
      get most() {
        return most;
      },
      clear: () => {
        counts.fill(0);
        most = 0;
      },
      // Points as in page.drawPoints; without `index` all have the first colour. Those of the first rows lie over the others.
      addPoints: (xs, ys, mask, wanted, index) => {
        for (let i = xs.length - 1; i >= 0; i--) {
          if (wanted !== null && mask[i] !== wanted) continue;
          const [x, y] = [xs[i], ys[i]];
          if (x >= 0 && y >= 0 && x < width - 1 && y < height - 1) put(y * width + x, index ? index[i] : 0);
        }
      },
      // Lines as in page.drawLines, one pixel wide: edges would be fainter than what lies alone may be.
      addLines: (rows, from, to, xs, ys, index) => {
        for (let i = from; i < to; i++) {
          const row = rows[i];
          for (let axis = 1; axis < xs.length; axis++) {
            const [y0, y1] = [ys[axis - 1][row], ys[axis][row]];
            if (!(y0 >= 0 && y1 >= 0)) continue;
            const across = xs[axis] - xs[axis - 1];
            const steps = Math.max(1, Math.round(Math.max(Math.abs(y1 - y0), across)));
            const [dx, dy] = [across / steps, (y1 - y0) / steps];
            let [x, y] = [xs[axis - 1] + 0.5, y0 + 0.5];
            for (let step = 0; step < steps; step++, x += dx, y += dy) {
              const [column, line] = [x | 0, y | 0];
              if (column < width && line < height) put(line * width + column, index ? index[row] : 0);
            }
          }
        }
      },
      // Points are two pixels wide and high. `above`: the levels below it are left to what lies behind.
      paint: (target, shades, asPoints, scaleTo = most, isSelected = false) => {
        const levels = levelsOf(scaleTo, isSelected ? SELECTED : 0);
        const last = levels.length - 1;
        for (let at = 0; at < counts.length; at++) {
          const count = counts[at];
          if (!count) continue;
          const shade = shades[colours[at] * LEVELS + levels[count < last ? count : last]];
          target[at] = shade;
          // Those of the next pixels are painted later, so that each keeps its own pixel.
          if (asPoints) target[at + 1] = target[at + width] = target[at + width + 1] = shade;
        }
      },
    };
  };

  const css = (pixel) => `rgb(${pixel & 255},${(pixel >> 8) & 255},${(pixel >> 16) & 255})`;

  // The colours of the key as a crowd has them, from what lies alone to the densest.
  page.crowdKey = (bar) => {
    const shades = page.shades();
    const at = (colour, level) => css(shades[colour * LEVELS + level]);
    const { palette } = page.paints();
    const strip = bar.querySelector(".strip");
    const levels = [0, 5, 10, LEVELS - 1];
    const bands = levels.map((level) => d3.range(0, palette.length - 1, 15).map((colour) => at(colour, level)));
    if (strip) {
      strip.classList.add("crowd");
      strip.dataset.bands = JSON.stringify(bands);
      strip.style.background = bands.map((stops, band) => `linear-gradient(to right, ${stops.join(",")}) 0 ${(100 * band) / 3}% / 100% 25% no-repeat`).join(",");
    }
    const swatches = [...bar.querySelectorAll(".swatch")];
    const perWord = (palette.length - 2) / Math.max(1, swatches.length - 1); // 1 unless there are more words than colours for them
    swatches.forEach((swatch, word) => {
      const colours = levels.map((level) => at(Math.round(word * perWord), level));
      swatch.style.background = `linear-gradient(to right, ${colours.join(",")})`;
      swatch.dataset.bands = JSON.stringify([colours]);
    });
    bar.append(page.element("div", { class: "bar-title", "data-testid": "crowd" }, `${page.denser()}: more designs in one place`));
  };
}
