// The yield of a design as its fresh draws tell it, with the interval in which it lies.
{
  const ENDS = ["yield_low", "yield_high"];

  page.intervalOf = (column, row) => {
    if (column.name !== "yield" && column.name !== "yield_screened") return null;
    const [value, low, high] = ["yield", ...ENDS].map((name) => page.front.byName.get(name)?.values[row] ?? NaN);
    return [value, low, high].every(Number.isFinite) ? { value, low, high } : null;
  };

  // Behind the value of a yield; the other one names the fresh draws too.
  page.intervalText = (column, row) => {
    const found = page.intervalOf(column, row);
    if (!found) return "";
    const ends = `${page.short(found.low)} to ${page.short(found.high)}`;
    return column.name === "yield" ? ` (${ends})` : ` (fresh draws: ${page.short(found.value)}, ${ends})`;
  };

  // Its ends stand behind it and need no line of their own.
  page.withoutEnds = (names, row) => {
    const told = names.filter((name) => page.intervalOf(page.front.byName.get(name), row));
    return told.length ? names.filter((name) => !ENDS.includes(name) && !(name === "yield" && told.length > 1)) : names;
  };

  // In a cell of the matrix, whose scales give pixels: the interval as a line through the design.
  page.intervalPath = (row, { x, y, xScale, yScale, size }) => {
    const clip = (at) => Math.max(0, Math.min(size, at));
    const at = [xScale, yScale].map((scale, i) => scale([x, y][i].values[row]));
    const across = page.intervalOf(x, row);
    const up = page.intervalOf(y, row);
    const parts = [];
    if (across) parts.push(`M${clip(xScale(across.low))},${at[1]}H${clip(xScale(across.high))}`);
    if (up) parts.push(`M${at[0]},${clip(yScale(up.low))}V${clip(yScale(up.high))}`);
    return parts.join("");
  };
}
