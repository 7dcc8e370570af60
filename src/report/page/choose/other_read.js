// Reads another result: a page of beltspace, or its front.csv. Nothing of it is run, and nothing leaves the page.
{
  const MOST = 300e6; // bytes
  const BEFORE = '<script type="application/json" id="data">';

  const refuse = (message) => {
    throw new Error(message);
  };

  const ofPage = async (text) => {
    const begin = text.indexOf(BEFORE);
    const end = text.indexOf("<\/script>", begin);
    if (begin < 0 || end < 0) refuse("it is not a page of beltspace: report.html of a result, or its front.csv, can be shown here");
    let data = null;
    try {
      data = JSON.parse(text.slice(begin + BEFORE.length, end));
    } catch {
      refuse("its data is broken; write the page again with beltspace report");
    }
    if (data.kind === "live") refuse("it is the page of beltspace explore, which has no numbers of its own; sweep the study, and load report.html");
    const { front } = data;
    if (!front || !Array.isArray(front.columns) || !front.rows) refuse("its page has no design on a front");
    let read = null;
    try {
      const buffer = await page.inflate(front.packed);
      if (buffer.byteLength !== page.packedBytes(front)) refuse("its numbers are not complete");
      read = page.frontOf(data, front, buffer);
    } catch {
      refuse("its numbers cannot be read; write the page again with beltspace report");
    }
    const byName = new Map(read.columns.filter((column) => !column.words && !column.exact).map((column) => [column.name, column]));
    const goals = read.objectives.map(({ column, goal }) => ({ name: column.name, goal }));
    // Results of one study in several forms have one title: the folder tells them apart.
    const folder = /([^/\\'" ]+)[/\\]study\.toml/.exec(String(data.evaluate ?? ""));
    return { title: String(data.title ?? ""), folder: folder && folder[1], rows: read.rows, byName, goals };
  };

  const ofTable = (text) => {
    const [names, ...rows] = d3.csvParseRows(text.replace(/^\ufeff/, ""));
    if (!names || names[0] !== "design_index") refuse("it is not a front.csv of beltspace: its first column is not design_index");
    const whole = rows.filter((row) => row.length > 1 || row[0] !== "");
    if (!whole.length) refuse("it has no design");
    const short = whole.findIndex((row) => row.length !== names.length);
    if (short >= 0) refuse(`row ${short + 2} has ${whole[short].length} cells where there should be ${names.length}`);
    const byName = new Map();
    names.forEach((name, at) => {
      if (at === 0 || name.endsWith("_scenario")) return;
      const values = Float64Array.from(whole, (row) => (row[at] === "" ? NaN : Number(row[at])));
      const isNumber = whole.every((row, i) => row[at] === "" || Number.isFinite(values[i]));
      if (isNumber) byName.set(name, page.withRange({ name, values, unit: null }));
    });
    return { title: "", rows: whole.length, byName, goals: null };
  };

  const goalsText = (goals) => goals.map(({ name, goal }) => `${name} (${goal})`).join(", ");

  // Two results are compared by the same objectives in the same units.
  const check = (found) => {
    const own = page.goals();
    if (found.goals && goalsText(d3.sort(found.goals, (it) => it.name)) !== goalsText(d3.sort(own, (it) => it.name))) refuse(`its objectives are ${goalsText(found.goals) || "none"}; here they are ${goalsText(own)}`);
    for (const { name, column } of own) {
      const theirs = found.byName.get(name);
      if (!theirs) refuse(`it has no numbers of ${name}, which is an objective here`);
      if (theirs.unit !== null && (theirs.unit || "") !== (column.unit || "")) refuse(`${name} is in ${page.unit(theirs.unit) || "no unit"} there and in ${page.unit(column.unit) || "no unit"} here`);
    }
    // What has another unit is not drawn with the other's numbers.
    for (const [name, theirs] of found.byName) {
      const here = page.front.byName.get(name);
      if (here && theirs.unit !== null && (theirs.unit || "") !== (here.unit || "")) found.byName.delete(name);
    }
  };

  // Can it be compared with the front shown? Goals of a study in work change.
  page.checkResult = check;

  page.readResult = async (file) => {
    if (file.size > MOST) refuse(`it has ${page.short(file.size / 1e6)} MB; ${MOST / 1e6} MB can be read here`);
    const text = await file.text();
    const isPage = /^\s*</.test(text.slice(0, 1000));
    const found = isPage ? await ofPage(text) : ofTable(text);
    check(found);
    return { ...found, file: file.name };
  };
}
