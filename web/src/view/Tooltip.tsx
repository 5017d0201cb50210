/** The title of the element that the pointer or the keyboard is on. */

import type { JSX } from "preact";
import { useEffect, useLayoutEffect, useMemo, useRef, useState } from "preact/hooks";
import { useFloating } from "./floating";
import { TitleWatch, type ShownTitle } from "./titles";

export function Tooltip(): JSX.Element | null {
  const [shown, setShown] = useState<ShownTitle | null>(null);
  const tip = useRef<HTMLDivElement>(null);
  const anchor = useMemo(() => ({ current: shown?.anchor ?? null }), [shown]);
  useEffect(() => {
    const watch = new TitleWatch(setShown);
    return () => {
      watch.close();
    };
  }, []);
  useLayoutEffect(() => {
    tip.current?.showPopover(); // above dialogs
  }, [shown]);
  useFloating(anchor, tip, "bottom", shown !== null);
  if (!shown) return null;
  // The element still says it to who does not see the page.
  return (
    <div key={shown.text} ref={tip} class="tooltip" popover="manual" aria-hidden="true">
      {shown.text}
    </div>
  );
}
