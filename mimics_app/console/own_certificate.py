"""A certificate of this computer's own for TLS, signed by an authority that nobody else has; kept until it expires."""

from __future__ import annotations

import re
from datetime import timedelta
from pathlib import Path

import trustme
from cryptography import x509
from cryptography.hazmat.primitives import hashes

from mimics_app.console.web_server import Certificate
from mimics_app.contracts.clock import wall_time
from mimics_app.contracts.system.whole_file import private_text

__all__ = ["fingerprint", "own_certificate"]

_VALID = timedelta(days=365)
_RENEWED = timedelta(days=7)
"""Time before its end at which a certificate is replaced."""


def own_certificate(folder: Path, host: str) -> Certificate:
    """Return the certificate for an address, made where there is none that is still valid for a week.

    Args:
        folder: Private folder for it.
        host: Address or name under which the page is reached.

    Raises:
        OSError: The folder cannot be written to.
    """
    name = re.sub(r"[^A-Za-z0-9.-]", "_", host)
    certificate, key = folder / f"{name}.pem", folder / f"{name}.key.pem"
    if not _is_valid(certificate) or not key.is_file():
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        authority = trustme.CA(organization_name="mimics operator's page")
        issued = authority.issue_cert(host, not_after=wall_time() + _VALID)
        chain = b"".join(blob.bytes() for blob in issued.cert_chain_pems)
        for file, content in ((key, issued.private_key_pem.bytes()), (certificate, chain)):
            with private_text(file) as stream:
                stream.write(content.decode())
    return Certificate(str(certificate), str(key))


def fingerprint(certificate: Certificate) -> str:
    """Return the SHA-256 fingerprint of a certificate as browsers show it, to be compared by a person."""
    return _read(Path(certificate.certificate)).fingerprint(hashes.SHA256()).hex(":").upper()


def _read(file: Path) -> x509.Certificate:
    return x509.load_pem_x509_certificate(file.read_bytes())


def _is_valid(file: Path) -> bool:
    try:
        return _read(file).not_valid_after_utc > wall_time() + _RENEWED
    except (OSError, ValueError):
        return False
