// What the author module is to have; goes when it has it.
import "htex";
declare module "htex" {
  interface Felt {
    centre_hz: number[]; reference_db: number[]; level_db: number[]; error_db: number[];
    error_rms_db: number; largest_error_db: number; total_error_db: number;
    below_difference_threshold: boolean; below_if_sensitive: boolean;
  }
  interface FeltSide { texture: Texture; model?: string; at?: Motion }
  interface Author {
    felt(reference: FeltSide, other: FeltSide): Felt;
    threshold(frequencies: ArrayLike<number>, options?: { quantity?: string }): Float64Array;
  }
}
