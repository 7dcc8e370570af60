// The answer to what is changed: asked at once, shown step by step, the newest question first.
{
  // A question that has had no exact answer for so long is given up for a newer one; one that is younger is awaited, so that the front
  // moves while a slider does. One that has its first idea, and whose exact answer will take longer than that, is given up at once.
  const PATIENCE = 120;
  let current = null; // { abort, since, exact, isLong }
  let wanted = null; // the newest question that was not asked yet: { set, eventAt }
  let started = false;
  let answered = 0;
  let ghostOf = null;
  let isFirst = true; // is the shown front a first idea only?
  let shown = { question: null, front: "", buffer: null };

  page.awaits = () => isFirst || !sameList(page.shownSet, page.changeList());

  const say = (text, kind) => {
    const line = page.byId("live-text");
    line.textContent = text;
    page.byId("live").dataset.kind = kind;
  };

  const sameList = (a, b) => String(a) === String(b);

  // The old front, as the one before the change that is being made.
  const keepGhost = () => {
    if (!page.front || !page.front.rows) return;
    const byName = new Map(page.front.columns.filter((column) => !column.words && !column.exact).map((column) => [column.name, { values: column.values, low: column.low, high: column.high }]));
    ghostOf = { byName, rows: page.front.rows };
  };

  page.showGhost = (on) => {
    page.ghost = on ? ghostOf : null;
    page.events.call("front");
  };

  // What the study says of itself comes with the first part of an answer.
  const describe = (told) => {
    const { data } = page;
    if (!told.study) return;
    const { controls } = data;
    const feasible = sameList(told.study.study.hash, data.study && data.study.hash) ? data.study.feasible : null;
    Object.assign(data, told.study, { controls });
    data.study.feasible = feasible;
  };

  // What is on the page already: the front of the few scenarios that decide is the exact one, as a rule.
  const isShown = (question, told, buffer) => {
    const is = shown.question === question && shown.front === JSON.stringify(told.front) && page.state.awaited === null && !page.awaitsPins();
    if (!is || shown.buffer.byteLength !== buffer.byteLength) return false;
    const [old, next] = [new Uint32Array(shown.buffer), new Uint32Array(buffer)];
    return next.every((word, i) => word === old[i]);
  };

  const put = (question, told, buffer) => {
    const { data } = page;
    describe(told);
    const isOld = isShown(question, told, buffer);
    isFirst = told.kind === "coarse" || told.kind === "few";
    if (isOld) return;
    shown = { question, front: JSON.stringify(told.front), buffer };
    Object.assign(data, { objectives: told.objectives, constraints: told.constraints, scenarios: told.scenarios });
    const { state } = page;
    // A card of a design that is not on the front follows the study as any other does.
    const isOfStudy = (known) => [page.shownSet, question.set].some((set) => sameList(known.set, set));
    const followed = state.known && isOfStudy(state.known) ? state.known.design : null;
    const design = page.front && state.card !== null ? page.designOf(state.card) : (state.awaited ?? followed);
    page.front = page.frontOf(data, told.front, buffer);
    // It is of what was asked before.
    if (!sameList(page.shownSet, question.set)) page.sample = null;
    page.shownSet = question.set;
    page.ghost = page.byId("ghost").checked ? ghostOf : null;
    page.adoptFront();
    const row = design === null ? -1 : page.rowOf(design);
    state.card = row < 0 ? null : row;
    if (row >= 0) state.known = null;
    // What a first front lacks may be on the exact one: until then the card stands as it is, and nothing on it can be pressed.
    state.awaited = row < 0 && page.awaits() ? design : null;
    const card = page.byId("card");
    page.holdCard(state.awaited !== null);
    if (!started && page.front.rows) begin();
    else if (started) page.events.call("front");
    for (const id of ["matrix-section", "parallel-section", "table-section", "bar"]) page.byId(id).hidden = !page.front.rows;
    // Whoever is at work elsewhere by now stays there.
    if (state.card !== null && card.hidden) page.openCard(state.card, document.activeElement === document.body);
    else if (design !== null && state.card === null && state.awaited === null) page.keepLost(design, question.set);
  };

  // No exact front comes. A card that waits for one is put away until a front has its design.
  const putCardAway = () => {
    const card = page.byId("card");
    if (page.state.awaited !== null && !card.hidden) page.closeLostCard();
    page.holdCard(false);
  };

  // The views, once there is something to see.
  const begin = () => {
    started = true;
    const open = page.readAddress();
    page.applySelection();
    page.startBar();
    page.startPins();
    page.startOthers();
    page.startWeigh();
    page.startMatrix();
    page.startStrip();
    page.startReadout();
    page.startParallel();
    page.startChooser();
    page.startTable();
    page.startCard();
    page.startAround();
    page.startAddress();
    open?.();
  };

  // What stands around the plots can wait until nothing moves.
  const later = page.afterPause(150, () => {
    page.startOverview();
    page.startStudy();
    page.byId("command").textContent = page.data.command;
  });

  const seconds = (s) => page.seconds(s);

  const part = (question, told, buffer) => {
    if (question !== current) return;
    if (told.kind === "error") {
      page.byId("live").dataset.kind = "error";
      say(told.message, "error");
      putCardAway();
      question.exact = true;
      return next();
    }
    if (told.kind === "counted") {
      Object.assign(page.data, { tally: told.tally, findings: told.findings.length ? told.findings : null });
      page.data.study.feasible = told.feasible ?? undefined;
      page.startOverview();
      page.startTally();
      page.feasible = page.sample = told.sample ? page.sampleOf(told.sample, buffer) : null;
      page.events.call("others");
      page.showExplained();
      const share = told.feasible === null ? `${page.percent(told.tally.feasible, told.tally.sampled)} of a sample are feasible` : `${page.count(told.feasible)} of ${page.count(page.data.study.designs)} designs are feasible`;
      say(`exact: ${page.count(page.front.rows)} designs on the front; ${share}`, "exact");
      page.timings.counted = answered;
      return;
    }
    if (told.kind === "certified") {
      put(question, told, buffer);
      page.timings.certified = answered;
      if (page.front.rows) say(`exact: ${page.count(page.front.rows)} designs on the front, each certified in f64; counting what is feasible …`, "exact");
      return;
    }
    // A first front of nothing says nothing of the exact one: until that is there the old one stays.
    const isEmpty = (told.kind === "coarse" || told.kind === "few") && !told.front.rows;
    if (isEmpty) describe(told);
    else put(question, told, buffer);
    page.showExplained(true);
    later();
    if (told.kind === "few") {
      say(`${page.count(told.front.rows)} designs, judged in the ${page.count(told.in_scenarios)} scenarios that decide; now in all ${page.count(page.data.study.scenarios)} …`, "coarse");
      page.timings.few = performance.now();
      const { eventAt } = question;
      requestAnimationFrame(() => setTimeout(() => page.timings.fews.push(eventAt === null ? null : performance.now() - eventAt)));
      return;
    }
    if (told.kind === "coarse") {
      say(`a first idea, of ${page.count(told.looked_at)} designs${told.draws ? ` in ${page.count(told.draws)} draws each` : ""}; the exact front follows …`, "coarse");
      if (!question.hasIdea) page.timings.coarse = performance.now();
      question.hasIdea = true;
      question.isLong = 1000 * told.exact_after > PATIENCE;
      return next();
    }
    question.exact = true;
    if (sameList(question.set, page.changeList())) document.body.classList.remove("older");
    answered++;
    const n = page.front.rows;
    say(n ? `exact: ${page.count(n)} designs on the front, in ${seconds(told.seconds)}` : "no design is feasible; looking for what stands in the way …", n ? "exact" : "none");
    if (!n && started === false) later();
    const { eventAt } = question;
    // After the frame in which it is painted.
    requestAnimationFrame(() => {
      const channel = new MessageChannel();
      channel.port1.onmessage = () => {
        const now = performance.now();
        page.timings.answers.push({ took: eventAt === null ? null : now - eventAt, engine: told.seconds, set: question.set });
        page.timings.answered = answered;
      };
      channel.port2.postMessage(0);
    });
    next();
  };

  const next = () => {
    if (!wanted) return;
    // An exact answer is there, or it has taken too long.
    if (current && !current.exact && !current.isLong && performance.now() - current.since < PATIENCE) return;
    if (current) current.abort.abort();
    const question = { ...wanted, abort: new AbortController(), since: performance.now(), exact: false, isLong: false, hasIdea: false };
    wanted = null;
    current = question;
    page.ask("/answer", { set: question.set }, (told, buffer) => part(question, told, buffer), question.abort.signal).then(
      () => {
        if (question === current) current = null;
        next();
      },
      (error) => {
        if (error.name === "AbortError" || question !== current) return;
        current = null;
        putCardAway();
        say(`the engine does not answer: ${error.message}. Is beltspace explore still running?`, "error");
        next();
      },
    );
    setTimeout(next, PATIENCE + 5);
  };

  page.asked = () => (wanted ? wanted.set : current ? current.set : null);
  page.isAnswered = () => !wanted && (!current || current.exact);

  page.startAnswers = () => {
    page.timings.answers = [];
    page.timings.fews = [];
    let settled = -Infinity;
    let computing = 0;
    const rest = page.afterPause(400, () => document.body.classList.remove("moves"));
    page.events.on("changes.answer", () => {
      document.body.classList.add("moves", "older");
      rest();
      // A ghost of what was there before the first of several changes in a row.
      if (performance.now() - settled > 600) keepGhost();
      settled = performance.now();
      // Until a first front comes, what is shown is of the question before. Where it comes at once nobody has to be told.
      clearTimeout(computing);
      computing = setTimeout(() => {
        const isOld = page.front && !sameList(page.shownSet, page.changeList());
        if (isOld && !page.isAnswered()) say("computing …; what is shown is of the study before the change", "coarse");
      }, 250);
      wanted = { set: page.changeList(), eventAt: page.eventAt ?? null };
      page.eventAt = null;
      next();
    });
    wanted = { set: page.changeList(), eventAt: null };
    next();
  };
}
