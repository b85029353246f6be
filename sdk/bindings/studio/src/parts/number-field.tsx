// A number that the user enters, or leaves to the file.

import { useEffect, useRef } from "preact/hooks";

interface Props {
  label: string;
  value: number | null | undefined;
  placeholder?: string;
  isRequired?: boolean;
  /** Least value; 0 unless another is given, null for none. */
  min?: number | null;
  /** The setting that it is, by which advice finds it. */
  setting?: string;
  onValue: (value: number | null) => void;
}

/** The number that stands in an input; null for none, and for one that is not yet whole, such as "0.". */
const numberIn = (input: HTMLInputElement) => (input.value === "" || Number.isNaN(input.valueAsNumber) ? null : input.valueAsNumber);

export function NumberField({ label, value = null, placeholder, isRequired = false, min = 0, setting, onValue }: Props) {
  const place = useRef<HTMLInputElement>(null);
  // What is being typed stays as it is typed.
  useEffect(() => {
    const input = place.current;
    if (input && numberIn(input) !== value) input.value = value === null ? "" : String(value);
  }, [value]);
  return (
    <label class="field">
      {label}
      <input ref={place} type="number" step="any" min={min ?? undefined} required={isRequired} data-setting={setting} placeholder={placeholder} onInput={(event) => onValue(numberIn(event.currentTarget))} />
    </label>
  );
}
