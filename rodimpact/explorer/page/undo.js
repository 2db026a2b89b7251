"use strict";
// Undo: the designs before the changes that were made. Begin with `UndoHistory`.

const MAX_UNDO = 100; // designs that are kept
const CHANGE_PAUSE = 800; // ms, after which a change of a number is a change of its own

class UndoHistory {
  /** `restore` is called with the design before the last change. */
  constructor(button, restore) {
    this.button = button;
    this.earlier = []; // designs as texts
    this.current = null;
    this.lastChange = -Infinity; // ms
    button.addEventListener("click", () => restore(this.back()));
    addEventListener("keydown", (event) => {
      const isUndo = (event.ctrlKey || event.metaKey) && event.key === "z";
      const isText = event.target.isContentEditable;
      if (!isUndo || isText || this.earlier.length === 0) {
        return;
      }
      event.preventDefault();
      restore(this.back());
    });
  }

  /** Keep a design; numbers that change without a pause are one change. */
  keep(design, isWholeChange) {
    const text = JSON.stringify(design);
    const moment = performance.now();
    const isPause = moment - this.lastChange > CHANGE_PAUSE;
    const isOther = this.current !== null && text !== this.current;
    if (isOther && (isWholeChange || isPause)) {
      this.earlier.push(this.current);
    }
    this.earlier.splice(0, this.earlier.length - MAX_UNDO);
    this.current = text;
    this.lastChange = isWholeChange ? -Infinity : moment;
    this.button.disabled = this.earlier.length === 0;
  }

  /** Let the next change of a number be a change of its own. */
  endChange() {
    this.lastChange = -Infinity;
  }

  /** Take back the last change; returns the design before it. */
  back() {
    this.current = null;
    return JSON.parse(this.earlier.pop());
  }
}
