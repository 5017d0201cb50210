/** A short text that is an edit once Enter is pressed or the field is left; Escape brings the saved one back. */

import type { JSX } from "preact";
import { useLayoutEffect, useRef } from "preact/hooks";

interface TextSettingProps {
  readonly label: string;
  /** As it is saved. */
  readonly value: string;
  readonly title: string;
  /** What stands where there is no text. */
  readonly placeholder?: string;
  /** Id of a list of texts to choose from. */
  readonly list?: string;
  /** Takes what was typed; resolves to whether that is saved. */
  readonly onType: (typed: string) => Promise<boolean>;
}

export function TextSetting({ label, value, title, placeholder, list, onType }: TextSettingProps): JSX.Element {
  const field = useRef<HTMLInputElement>(null);
  useLayoutEffect(() => {
    const input = field.current;
    if (input && input.dataset.saved !== value) input.value = input.dataset.saved = value;
  });
  return (
    <label class="choice">
      <span>{label}</span>
      <input
        ref={field}
        type="text"
        class="value"
        list={list}
        maxLength={100}
        placeholder={placeholder}
        title={title}
        onKeyDown={({ key, currentTarget }) => {
          if (key === "Escape") currentTarget.value = value;
        }}
        onChange={({ currentTarget }) => {
          void onType(currentTarget.value).then((isSaved) => {
            if (!isSaved) currentTarget.value = value;
          });
        }}
      />
    </label>
  );
}
