// What the package is to have; goes when it has it.
import "htex";
declare module "htex" {
  interface Texture {
    toBytes(): Uint8Array;
    parameters(o?: { model?: string; at?: object }): Record<string, number | number[]>;
    law: unknown;
  }
  interface Voice { spectrum(f: Float64Array): Float64Array }
  interface HtexNode {
    load(t: Texture, o?: object): void;
    onenvelope: ((e: { level: number; centroid: number }) => void) | null;
  }
  interface NodeOptions { pitch?: number }
  interface Author { make(spec: object): Texture; models(): any[] }
}
