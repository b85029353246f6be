"""Signatures of embedded modules (htex-1.md section 10)."""

from __future__ import annotations

import re

from cryptography.exceptions import InvalidSignature
from cryptography.hazmat.primitives.asymmetric.ed25519 import Ed25519PublicKey

KEY, SIGNATURE = re.compile(r"[0-9a-fA-F]{64}"), re.compile(r"[0-9a-fA-F]{128}")
P = 2**255 - 19
D = -121665 * pow(121666, P - 2, P) % P


def signed_text(plugin: dict) -> bytes:
    parts = ("htex plugin 1", plugin["model"], plugin["version"], plugin["blake3"])
    return b"".join(part.encode("utf-8") + b"\0" for part in parts)


def signature_is_valid(plugin: dict) -> bool:
    signature = plugin["signature"]
    if not KEY.fullmatch(signature["public_key"]) or not SIGNATURE.fullmatch(signature["ed25519"]):
        return False
    key, value = bytes.fromhex(signature["public_key"]), bytes.fromhex(signature["ed25519"])
    if is_small_order(key) or is_small_order(value[:32]):
        return False
    try:
        Ed25519PublicKey.from_public_bytes(key).verify(value, signed_text(plugin))
    except (InvalidSignature, ValueError):
        return False
    return True


def is_small_order(encoded: bytes) -> bool:
    """Whether eight times the point is the neutral one, or it is no point."""
    y = (int.from_bytes(encoded, "little") & (2**255 - 1)) % P
    u, v = (y * y - 1) % P, (D * y * y + 1) % P
    # x^2 = u / v; only y and x^2 are needed to double.
    x2 = u * pow(v, P - 2, P) % P
    if pow(x2, (P - 1) // 2, P) not in (0, 1):
        return True
    for _ in range(3):
        y2 = y * y % P
        y_new = (y2 + x2) * pow((1 - D * x2 * y2) % P, P - 2, P) % P
        x2_new = 4 * x2 * y2 * pow((1 + D * x2 * y2) ** 2 % P, P - 2, P) % P
        y, x2 = y_new, x2_new
    return x2 == 0 and y == 1
