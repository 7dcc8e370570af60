// Lines of a table that open something: one stop for the tab key, arrows go from line to line and to the buttons above, Enter and a click
// open.
page.openableRows = (body, open) => {
  const lineOf = (event) => event.target.closest("tr[data-row]");
  const stopAt = (line) => {
    for (const old of body.querySelectorAll('tr[tabindex="0"]')) if (old !== line) old.setAttribute("tabindex", -1);
    line?.setAttribute("tabindex", 0);
  };
  body.addEventListener("click", (event) => lineOf(event) && !event.target.closest("button, a") && open(lineOf(event)));
  body.addEventListener("focusin", (event) => lineOf(event) && stopAt(lineOf(event)));
  body.addEventListener("keydown", (event) => {
    const line = lineOf(event);
    if (!line || event.target !== line) return;
    const lines = [...body.querySelectorAll("tr[data-row]")];
    const at = lines.indexOf(line);
    const above = body.parentNode.querySelector("thead button");
    const next = { ArrowDown: lines[at + 1], ArrowUp: at > 0 ? lines[at - 1] : above, Home: lines[0], End: lines[lines.length - 1] };
    if (event.key in next) next[event.key]?.focus();
    else if (event.key === "Enter") open(line);
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  // After the lines have changed.
  return (line = null) => stopAt(line ?? body.querySelector("tr[data-row]"));
};

// What the arrow keys reach in a plot is said aloud.
page.announce = (row) => {
  const { front, state } = page;
  if (row === null || row === undefined) return;
  const said = state.matrix.map((name) => {
    const column = front.byName.get(name);
    return `${name} ${page.valueText(column, row)}${column.words ? "" : ` ${page.unit(column.unit)}`}`;
  });
  page.say(`design ${page.designOf(row)}${row === page.chosenRow() ? `, ${page.chosenWord()}` : ""}: ${said.join(", ")}`);
};
