// What is changed in the study: parts of it with their values, as --set takes them; undone, done again, and part of the address.
{
  let changed = new Map(); // part -> value as text
  let undo = [];
  let redo = [];
  let gesture = null; // the part of the slider that is being dragged: all of that is one step

  page.changes = () => changed;
  page.changeList = (map = changed) => [...map].map(([part, value]) => `${part}=${value}`);
  page.changedValue = (part) => changed.get(part);
  page.canUndo = () => undo.length > 0;
  page.canRedo = () => redo.length > 0;

  const tell = () => page.events.call("changes");

  // Gives parts values; null takes a change back. `drag` names a gesture, whose changes are undone together.
  page.change = (parts, drag = null) => {
    const next = new Map(changed);
    for (const [part, value] of Object.entries(parts)) {
      if (value === null || value === undefined) next.delete(part);
      else next.set(part, String(value));
    }
    if (String([...next]) === String([...changed])) return;
    if (drag === null || drag !== gesture) {
      undo.push(changed);
      if (undo.length > 200) undo.shift();
    }
    gesture = drag;
    redo = [];
    changed = next;
    tell();
  };

  page.endGesture = () => (gesture = null);

  const step = (from, to) => {
    if (!from.length) return;
    to.push(changed);
    changed = from.pop();
    gesture = null;
    tell();
  };
  page.undoChange = () => step(undo, redo);
  page.redoChange = () => step(redo, undo);

  const asMap = (list) => new Map(list.map((text) => [text.slice(0, text.indexOf("=")), text.slice(text.indexOf("=") + 1)]));

  // Those of the address that was opened: there is nothing before them to go back to.
  page.beginChanges = (list) => (changed = asMap(list));

  page.resetChanges = (list = []) => {
    const next = asMap(list);
    if (String([...next]) === String([...changed])) return false;
    undo.push(changed);
    redo = [];
    gesture = null;
    changed = next;
    tell();
    return true;
  };

  // In the address: part:value, separated by semicolons. Without changes the file's own study.
  page.changesText = () => [...changed].map(([part, value]) => `${encodeURIComponent(part)}:${encodeURIComponent(value)}`).join(";");

  const decode = (text) => {
    try {
      return decodeURIComponent(text);
    } catch {
      return "";
    }
  };

  page.changesOfAddress = () => {
    const given = location.hash.slice(1).split("&").find((part) => part.startsWith("s="));
    if (!given) return [];
    const parts = given.slice(2).split(";").map((part) => part.split(":").map(decode));
    return parts.filter(([part, value]) => part && value).map(([part, value]) => `${part}=${value}`);
  };

  // The address was changed by hand or with the buttons of the browser.
  page.readChanges = () => page.resetChanges(page.changesOfAddress());
}
