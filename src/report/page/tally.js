// What limits feasibility; if nothing is feasible, this comes first on the page.
{
  // Every reason for which a design of the sample failed: a status of the model or a constraint, the most frequent first.
  const reasons = (tally) => {
    const states = Object.entries(tally.status || {}).map(([reason, failed]) => ({ text: reason, failed, only: 0, constraint: false }));
    const bounds = (tally.constraints || []).map(({ of, bounds, violated, only }) => ({ text: `${of} ${page.grouped(bounds)}`, of, bounds, failed: violated, only, constraint: true }));
    return [...states, ...bounds].sort((a, b) => b.failed - a.failed);
  };

  // What is counted: designs or draws, how it is introduced, and how many there are in all.
  const drawTally = (tally, { one, title, id, all: whole, good }) => {
    const section = page.byId("tally");
    section.hidden = false;
    const { sampled } = tally;
    const all = reasons(tally);
    const shown = all.filter((reason) => reason.failed > 0);
    const never = all.filter((reason) => reason.failed === 0).map((reason) => reason.text);
    const line = ({ text, failed, only, constraint }) => {
      const meter = page.element("span", { class: "meter wide", role: "img", "aria-label": `${page.percent(failed, sampled)} fail${constraint ? `, ${page.percent(only, sampled)} only this` : ""}` });
      for (const [part, kind] of [[only, "alone"], [failed - only, "shared"]]) {
        const fill = page.element("span", { class: `fill ${kind}` });
        fill.style.width = `${(100 * part) / sampled}%`;
        meter.append(fill);
      }
      const kind = constraint ? "constraint" : "impossible";
      return page.element("tr", { "data-reason": text }, page.element("th", { scope: "row" }, text), page.element("td", { class: "muted" }, kind), page.element("td", { class: "bar-cell" }, meter), page.element("td", { class: "number" }, page.percent(failed, sampled)), page.element("td", { class: "number" }, constraint ? page.percent(only, sampled) : "–"));
    };
    const head = [["reason", ""], ["kind", ""], ["share", ""], ["fails", "number"], ["alone", "number"]].map(([name, kind]) => page.element("th", { scope: "col", class: kind }, name));
    const table = page.element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": `${title}: reasons and their shares` }, page.element("table", { class: "tally" }, page.element("thead", {}, page.element("tr", {}, head)), page.element("tbody", {}, shown.map(line))));
    const heading = page.element("h2", { id }, title);
    section.append(
      heading,
      page.element("p", { class: "hint" }, `Of ${whole === sampled ? "all" : "a fixed sample of"} ${page.count(sampled)} ${one}s, ${page.count(tally.feasible)} (${page.percent(tally.feasible, sampled)}) ${good}. One ${one} may fail for several reasons; “alone” counts those that fail this constraint and nothing else.`),
      shown.length ? table : page.element("p", {}, `No ${one} fails.`),
      shown.length && never.length ? page.element("p", { class: "hint" }, `No ${one} fails: ${never.join(", ")}.`) : "",
    );
    if (shown.length) page.saveButtons(heading, id.replace("-title", ""), () => table.firstChild);
  };

  const sentences = (tally) => {
    const all = reasons(tally).filter((reason) => reason.failed > 0);
    const [first] = all;
    if (!first) return ["No single constraint or status excludes every design of the sample, but together they do: no design keeps all of them in all scenarios."];
    const count = `${page.count(first.failed)} of ${page.count(tally.sampled)} ${page.data.study && page.data.study.designs === tally.sampled ? "" : "sampled "}designs (${page.percent(first.failed, tally.sampled)})`;
    const said = [first.constraint ? `The most frequent reason: ${count} violate the constraint “${first.text}”.` : `The most frequent reason: ${count} have the status “${first.text}”.`];
    const { draws } = page.data;
    const [worst] = draws ? reasons(draws).filter((reason) => reason.constraint && reason.failed > 0) : [];
    if (worst) said.push(`Of the draws, ${page.percent(worst.failed, draws.sampled)} fail at “${worst.text}”.`);
    const alone = all.filter((reason) => reason.only > 0).sort((a, b) => b.only - a.only);
    if (alone.length) said.push(`What to relax: ${alone.map((reason) => `“${reason.text}”, which alone excludes ${page.count(reason.only)} designs (${page.percent(reason.only, tally.sampled)})`).join("; ")}. These designs keep all other constraints.`);
    else if (first.constraint) said.push("No design is excluded by one constraint alone, so relaxing one is not enough. Relax several, widen the ranges of the design inputs, or ask for fewer operating points.");
    if (!first.constraint) said.push("This is not a constraint that could be relaxed: widen or move the ranges of the design inputs, or ask for less in [operation] and [uncertainty].");
    return said;
  };

  // How far off feasibility is, ends of axes on which the front stands, quantities below zero that no constraint forbids.
  const drawFindings = (place, findings) => {
    const list = page.element("ul", { class: "findings", "data-testid": "findings" }, findings.map((text) => page.element("li", {}, page.grouped(text))));
    place.append(page.element("h2", {}, "Findings"), list);
  };

  page.startTally = () => {
    const { data, front } = page;
    page.byId("tally").replaceChildren();
    page.byId("tally").hidden = true;
    const { tally, study, findings } = data;
    if (tally) drawTally(tally, { one: "design", title: "What limits feasibility", id: "tally-title", all: study && study.designs, good: "are feasible" });
    if (data.draws) drawTally(data.draws, { one: "draw", title: "What draws fail at", id: "draws-title", all: data.draws.draws, good: "hold" });
    const none = study && (study.feasible === 0 || (front && front.rows === 0 && front.objectives.length));
    // On the page of `explore` they come a moment after the front: above the plots they would push these down.
    const place = page.byId(tally && data.kind === "live" ? "tally" : "overview");
    if (findings && !none) drawFindings(place, findings);
    const lead = page.byId("lead");
    lead.hidden = !none;
    // Of a study in work it goes back where it was once something is feasible again.
    if (!none) return void page.byId("explained").after(page.byId("tally"));
    lead.replaceChildren(page.element("h2", {}, "No design is feasible: what limits it"), ...(tally ? sentences(tally) : ["The result does not say why."]).map((text) => page.element("p", {}, text)));
    if (findings) drawFindings(lead, findings);
    if (tally) lead.after(page.byId("tally"));
  };
}
