// Titles and ticks of the axes of cells and of other plots.
{
  page.axisLabel = (column) => page.withUnit(column.name, column.unit) + (column.goal ? ` (${column.goal})` : "");

  const pen = document.createElement("canvas").getContext("2d");
  const widthOf = (text, size) => {
    pen.font = `${size}px ${getComputedStyle(document.body).fontFamily}`;
    return pen.measureText(text).width;
  };

  // Words in as few lines as hold them.
  const broken = (text, room, size) =>
    text.split(" ").reduce((lines, word) => {
      const longer = lines.length ? `${lines[lines.length - 1]} ${word}` : word;
      if (lines.length && widthOf(longer, size) <= room) lines[lines.length - 1] = longer;
      else lines.push(word);
      return lines;
    }, []);

  // The title of an axis in the room that there is: { lines, size, whole }. Letters are made smaller, never narrower; what still has
  // no room is cut off.
  const SIZES = [12, 11, 10, 9.5];
  const wordyTitle = (column) => page.axisName(column.name, column.unit) + (column.goal ? `, ${column.goal === "min" ? "lower" : "higher"} is better` : "");
  page.hasRoomForWords = (column, room) => widthOf(wordyTitle(column), SIZES[0]) <= room;
  // `wordy`: the goal in words if they have room.
  page.axisTitle = (column, room, most, wordy = true) => {
    const name = page.axisName(column.name, column.unit);
    const wide = wordyTitle(column);
    if ((wordy || !column.goal) && page.hasRoomForWords(column, room)) return { lines: [wide], size: SIZES[0], whole: wide };
    const whole = name + (column.goal ? ` (${column.goal})` : "");
    const least = SIZES[SIZES.length - 1];
    const size = SIZES.find((it) => broken(whole, room, it).every((line, at) => at < most && widthOf(line, it) <= room)) ?? least;
    const lines = broken(whole, room, size);
    const cut = (line, isEnd) => {
      if (widthOf(line, size) <= room && !isEnd) return line;
      while (line.length > 1 && widthOf(`${line}…`, size) > room) line = line.slice(0, -1);
      return `${line}…`;
    };
    return { lines: lines.slice(0, most).map((line, at) => cut(line, at === most - 1 && lines.length > most)), size, whole };
  };

  // The lines of a title below one another, as the text of an SVG.
  page.writeTitle = (text, { lines, size, whole }, x = 0) => {
    text.attr("text-anchor", "middle").style("font-size", `${size}px`);
    lines.forEach((line, at) => text.append("tspan").attr("x", x).attr("dy", at ? "1.1em" : 0).text(line));
    if (lines.join(" ") !== whole) text.append("title").text(whole);
  };

  // Numbers below an axis of so many pixels: those at its ends stay within it, and one that would touch the one before is left out. Where
  // that leaves one only, the last one stands beside it if there is room. Returns how many there are.
  page.keepTicksApart = (axis, length) => {
    const ticks = axis.selectAll(".tick").nodes().map((tick) => {
      const text = d3.select(tick).select("text");
      const at = Number(/[-\d.]+/.exec(tick.getAttribute("transform"))[0]);
      const wide = widthOf(text.text(), 12);
      const anchor = at < wide / 2 - 4 ? "start" : at > length - wide / 2 + 4 ? "end" : "middle";
      const left = at - wide * { start: 0, middle: 0.5, end: 1 }[anchor];
      text.attr("text-anchor", anchor);
      return { text, left, right: left + wide };
    });
    const apart = (kept, tick) => (kept.length && tick.left < kept[kept.length - 1].right + 5 ? kept : [...kept, tick]);
    let kept = ticks.reduce(apart, []);
    if (kept.length === 1 && ticks.length > 1) kept = [ticks[0], ticks[ticks.length - 1]].reduce(apart, []);
    ticks.filter((tick) => !kept.includes(tick)).forEach(({ text }) => text.text(""));
    return kept.length;
  };

  // On an axis of words every word has a tick.
  page.axisOf = (orient, column, scale, count) => {
    const axis = orient(scale).tickSizeOuter(0).tickSize(4).tickPadding(4);
    if (column.words) return axis.tickValues(d3.range(column.words.length)).tickFormat((i) => page.wordText(column.words[i]));
    if (Number.isNaN(column.low)) return axis.tickValues([]);
    // Around a value that stands alone there is nothing to measure; where there is a range, its ticks are those of any other axis.
    const [from, to] = scale.domain();
    if (column.low === column.high && to - from <= 0.2 * (Math.abs(column.low) || 10)) return axis.tickValues([column.low]).tickFormat(page.exactly);
    // A whole number has no digits after its point, however few of them there are. With fewer than two numbers an axis tells nothing.
    const ticksOf = (most) => scale.ticks(most).filter((tick) => !column.whole || Number.isInteger(tick));
    const most = d3.range(count, count + 10).find((it) => ticksOf(it).length > 1) ?? count;
    const isFine = column.whole && scale.ticks(most).some((tick) => !Number.isInteger(tick));
    return axis.tickValues(ticksOf(most)).tickFormat(isFine ? page.count : page.tick(scale, most));
  };
}
