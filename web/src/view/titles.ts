/** Titles of elements, shown by the page in place of the browser: sooner, in its own type, and for the keyboard, too. */

/** A title that is shown, and its element. */
export interface ShownTitle {
  readonly anchor: Element;
  readonly text: string;
}

const DELAY_MS = 500;

/** Watches which element with a title the pointer, or the keyboard by Tab, is on. */
export class TitleWatch {
  readonly #show: (shown: ShownTitle | null) => void;
  readonly #listening = new AbortController();
  readonly #changes = new MutationObserver(() => {
    this.#takeChange();
  });
  /** The element that the pointer is on, without its title, so that the browser does not show it, too. */
  #hovered: HTMLElement | null = null;
  #text = "";
  #timer = 0;
  #isByTab = false;

  constructor(show: (shown: ShownTitle | null) => void) {
    this.#show = show;
    const options = { capture: true, signal: this.#listening.signal };
    const leave = (): void => {
      this.#leave();
    };
    document.addEventListener(
      "pointerover",
      (event) => {
        if (event.pointerType === "mouse") this.#hover(event.target);
      },
      options,
    );
    document.documentElement.addEventListener("pointerleave", leave, { signal: this.#listening.signal });
    document.addEventListener(
      "keydown",
      ({ key }) => {
        this.#isByTab = key === "Tab";
        this.#hide();
      },
      options,
    );
    document.addEventListener(
      "pointerdown",
      () => {
        this.#isByTab = false;
        this.#hide();
      },
      options,
    );
    document.addEventListener(
      "focusin",
      ({ target }) => {
        if (this.#isByTab && target instanceof HTMLElement && target.title) this.#await(target, target.title);
      },
      options,
    );
    document.addEventListener(
      "scroll",
      () => {
        this.#hide();
      },
      options,
    );
    addEventListener("blur", leave, { signal: this.#listening.signal });
  }

  close(): void {
    this.#listening.abort();
    this.#leave();
  }

  #hover(target: EventTarget | null): void {
    const found = target instanceof Element ? target.closest<HTMLElement>("[title]") : null;
    const isInside = target instanceof Node && (this.#hovered?.contains(target) ?? false);
    if (isInside && (!found || found.contains(this.#hovered))) return;
    this.#leave();
    if (!found?.title) return;
    [this.#hovered, this.#text] = [found, found.title];
    found.removeAttribute("title");
    this.#changes.observe(found, { attributes: true, attributeFilter: ["title"] });
    this.#await(found, this.#text);
  }

  /** Shows a title after a while. */
  #await(anchor: Element, text: string): void {
    clearTimeout(this.#timer);
    this.#timer = window.setTimeout(() => {
      if (anchor.isConnected) this.#show({ anchor, text: anchor === this.#hovered ? this.#text : text });
    }, DELAY_MS);
  }

  /** Takes a title that the page has changed while it is shown. */
  #takeChange(): void {
    const hovered = this.#hovered;
    if (!hovered?.hasAttribute("title")) return;
    this.#text = hovered.title;
    hovered.removeAttribute("title");
    this.#hide();
    if (this.#text) this.#await(hovered, this.#text);
  }

  #leave(): void {
    this.#hide();
    this.#changes.disconnect();
    const hovered = this.#hovered;
    this.#hovered = null;
    // What the page has set meanwhile, and was not taken yet, is newer.
    if (hovered && !hovered.hasAttribute("title") && this.#text) hovered.title = this.#text;
  }

  #hide(): void {
    clearTimeout(this.#timer);
    this.#show(null);
  }
}
