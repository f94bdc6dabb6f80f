"""Encrypted macros (.ngx): aircut's own container (AMB-CALL-7).

The text of a macro is encrypted with AES-256-GCM under a key that scrypt makes from a
password. `docs/reference/ngx.md` describes the container byte by byte. A checksum that
needs no key ends it, so that a damaged file is told from a wrong key.
"""

from __future__ import annotations

import hashlib
import os
import struct
import unicodedata

MAGIC = b"\x89AIRCUT\n"
VERSION = 1
SCRYPT = 1  # how the key is made from the password
AES_256_GCM = 1  # how the text is encrypted
LOG_N, R, P = 15, 8, 1  # what a new file costs: 32 MiB and about a tenth of a second
MAX_LOG_N, MAX_R, MAX_P = 18, 16, 4  # what a file may cost: at most 512 MiB

#: magic, version, key derivation, log2 n, r, p, cipher, two zero bytes, salt, nonce.
HEADER = struct.Struct("<8s6B2x16s12s")
TAG = 16
DIGEST = 32
LINE = 250  # bytes of a line, its end not counted (source: 000 section 3.3.3)
MAX_BYTES = 64 * 2**20

UNREADABLE = "encrypted macro cannot be read: "
BOM = b"\xef\xbb\xbf"


class NgxError(Exception):
    """Text cannot be encrypted, or a container not be read; the message says why.

    line: from 1, where one line is at fault, else 0.
    """

    def __init__(self, message: str, line: int = 0) -> None:
        super().__init__(message)
        self.line = line


def encrypt(text: bytes, key: str) -> bytes:
    """The container that holds a macro's text. The same text gives other bytes each time.

    text: any bytes, in lines of at most 250.    key: the password, not empty.
    Raises NgxError.
    """
    if len(text) > MAX_BYTES:
        raise NgxError(f"macro is too large: {len(text)} bytes, at most {MAX_BYTES}")
    if found := long_line(text):
        line, length = found
        raise NgxError(f"line has {length} bytes, at most {LINE} in an encrypted macro", line)
    password = encoded(key)
    salt, nonce = os.urandom(16), os.urandom(12)
    header = HEADER.pack(MAGIC, VERSION, SCRYPT, LOG_N, R, P, AES_256_GCM, salt, nonce)

    from cryptography.hazmat.primitives.ciphers.aead import AESGCM

    body = header + AESGCM(derive(password, salt, LOG_N, R, P)).encrypt(nonce, text, header)
    return body + hashlib.sha256(body).digest()


def decrypt(data: bytes, key: str) -> bytes:
    """The text in a container, byte for byte as it was encrypted.

    Raises NgxError: not aircut's container, damaged, from a newer aircut, or a wrong key.
    The checksum tells damage from a wrong key; a file altered on purpose and given a new
    checksum looks like a wrong key.
    """
    if not data.startswith(MAGIC):
        raise NgxError(UNREADABLE + "not an aircut container")
    body, digest = data[:-DIGEST], data[-DIGEST:]
    if hashlib.sha256(body).digest() != digest:
        raise NgxError(UNREADABLE + "the file is damaged or cut off")
    if body[len(MAGIC) :][:1] != bytes([VERSION]):
        raise NgxError(UNREADABLE + "its container is of a version that this aircut does not know")
    if len(body) < HEADER.size + TAG:
        raise NgxError(UNREADABLE + "the file is damaged or cut off")
    header = body[: HEADER.size]
    _, _, derivation, log_n, r, p, cipher, salt, nonce = HEADER.unpack(header)
    if derivation != SCRYPT or cipher != AES_256_GCM:
        raise NgxError(UNREADABLE + "it is encrypted in a way that this aircut does not know")
    if not (1 <= log_n <= MAX_LOG_N and 1 <= r <= MAX_R and 1 <= p <= MAX_P):
        raise NgxError(UNREADABLE + "making its key would take too much memory or time")
    if len(body) > HEADER.size + TAG + MAX_BYTES:
        raise NgxError(UNREADABLE + "it is too large")
    password = encoded(key)

    from cryptography.exceptions import InvalidTag
    from cryptography.hazmat.primitives.ciphers.aead import AESGCM

    try:
        return AESGCM(derive(password, salt, log_n, r, p)).decrypt(nonce, body[HEADER.size :], header)
    except InvalidTag:
        raise NgxError(UNREADABLE + "wrong key (or the file was altered on purpose)") from None


def long_line(text: bytes) -> tuple[int, int] | None:
    """The first line of more than 250 bytes: its number from 1, and its bytes; None if there is none.

    Lines end as in `aircut.source`: LF, CR LF, or CR alone where there is no LF.
    """
    text = text.removeprefix(BOM)
    if b"\n" not in text:
        text = text.replace(b"\r", b"\n")
    for number, line in enumerate(text.split(b"\n"), 1):
        if (length := len(line.removesuffix(b"\r"))) > LINE:
            return number, length
    return None


def encoded(key: str) -> bytes:
    """The password as scrypt takes it: Unicode NFC, so that it does not matter how it was typed; UTF-8.

    Raises NgxError.
    """
    if not key:
        raise NgxError("the key is empty")
    try:
        return unicodedata.normalize("NFC", key).encode("utf-8")
    except UnicodeEncodeError:
        raise NgxError("the key is not text") from None


def derive(password: bytes, salt: bytes, log_n: int, r: int, p: int) -> bytes:
    """32 bytes of key by scrypt. Takes 128·r·2**log_n bytes of memory.    Source: RFC 7914."""
    from cryptography.hazmat.primitives.kdf.scrypt import Scrypt

    return Scrypt(salt=salt, length=32, n=2**log_n, r=r, p=p).derive(password)
