// Questions to the engine: a request whose answer comes in parts, each a description and numbers.
{
  const text = new TextDecoder();

  // Calls `each` with every part as it comes; ends when the answer does. `signal` ends it before.
  page.ask = async (path, question, each, signal) => {
    const response = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json" },
      body: JSON.stringify({ ...question, tab: page.tab }),
      signal,
    });
    if (!response.ok) throw new Error((await response.text()).trim());
    const reader = response.body.getReader();
    let held = new Uint8Array(0);
    for (;;) {
      const { done, value } = await reader.read();
      if (done) return;
      const joined = new Uint8Array(held.length + value.length);
      joined.set(held);
      joined.set(value, held.length);
      held = joined;
      for (;;) {
        if (held.length < 8) break;
        const view = new DataView(held.buffer, held.byteOffset);
        const [words, numbers] = [view.getUint32(0, true), view.getUint32(4, true)];
        const end = 8 + words + numbers;
        if (held.length < end) break;
        const told = JSON.parse(text.decode(held.subarray(8, 8 + words)));
        const buffer = held.slice(8 + words, end).buffer;
        held = held.slice(end);
        each(told, buffer);
      }
    }
  };

  // The only part of a short answer.
  page.askOnce = async (path, question, signal) => {
    let found = null;
    await page.ask(path, question, (told) => (found = told), signal);
    if (!found) throw new Error("there was no answer");
    if (found.kind === "error") throw new Error(found.message);
    return found;
  };

  page.tab = Math.floor(Math.random() * 2 ** 48) + 1;
}
