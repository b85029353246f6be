// A text that the user enters. What is being typed stays as it is typed; otherwise the field follows the value.

import { useEffect, useRef } from "preact/hooks";

interface Props {
  label: string;
  value: string;
  isRequired?: boolean;
  /** Lines; 1 is a field of one line. */
  rows?: number;
  /** Id of a list of suggestions. */
  list?: string;
  onText: (text: string) => void;
  /** The field was left, or the text was confirmed. */
  onSettled: () => void;
}

export function TextField({ label, value, isRequired = false, rows = 1, list, onText, onSettled }: Props) {
  const place = useRef<HTMLInputElement & HTMLTextAreaElement>(null);
  const show = () => {
    if (place.current && place.current.value !== value) place.current.value = value;
  };
  useEffect(() => {
    if (place.current !== document.activeElement) show();
  }, [value]);
  const common = {
    ref: place,
    dir: "auto" as const,
    required: isRequired,
    onInput: (event: Event) => onText((event.currentTarget as HTMLInputElement).value),
    // `onChange` would be called at every key, as React does.
    onChangeCapture: onSettled,
    // A name that was emptied is the last one again.
    onBlur: (event: Event) => (event.currentTarget as HTMLInputElement).value.trim() === "" && show(),
  };
  return (
    <label class="field">
      {label}
      {rows > 1 ? <textarea rows={rows} {...common} /> : <input type="text" list={list} {...common} />}
    </label>
  );
}
