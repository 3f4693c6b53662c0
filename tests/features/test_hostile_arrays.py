"""Files of arrays and weights that hold pickles, claim absurd sizes or are random bytes: nothing in them is run."""

from __future__ import annotations

import io
import os
import pickle
import zipfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from features import arrays as arrays_module
from features.arrays import ArtifactError, load_arrays, save_arrays
from features.object_feature import WeightsError, _loaded
from features.percept_data import load_percepts
from features.transforms import load_transforms
from model.fits import load as load_fit
from tests.fuzz import FEW, MANY, MUTATIONS, Mutation, examples, mutated


def load_weights(path: Path) -> Any:
    return _loaded(str(path), {"features.0.weight": (2, 3)})


LOADERS: dict[str, tuple[Callable[[Path], Any], type[Exception]]] = {
    "arrays": (lambda path: load_arrays(path, "test", ("numbers", "texts")), ArtifactError),
    "transforms": (load_transforms, ArtifactError),
    "percepts": (load_percepts, ArtifactError),
    "fit": (load_fit, ValueError),
    "weights": (load_weights, WeightsError),
}


class Evil:
    """Unpickled, it makes a folder."""

    def __init__(self, sign: Path) -> None:
        self.sign = sign

    def __reduce__(self) -> Any:
        return os.mkdir, (str(self.sign),)


def as_npz(evil: Evil, name: str = "numbers") -> bytes:
    stream = io.BytesIO()
    np.savez(
        stream, allow_pickle=True, kind=np.array("test"), texts=np.array(["a"]), **{name: np.array([evil], object)}
    )
    return stream.getvalue()


def as_npy(evil: Evil) -> bytes:
    stream = io.BytesIO()
    np.save(stream, np.array([evil], object), allow_pickle=True)
    return stream.getvalue()


def as_torch(evil: Evil, **options: Any) -> bytes:
    import torch

    stream = io.BytesIO()
    torch.save({"features.0.weight": torch.zeros(2, 3), "evil": evil}, stream, **options)
    return stream.getvalue()


PICKLES: dict[str, Callable[[Evil], bytes]] = {
    "pickle": pickle.dumps,
    "old pickle": lambda evil: pickle.dumps(evil, protocol=0),
    "npz": as_npz,
    "npz, array of another name": lambda evil: as_npz(evil, "other"),
    "npy": as_npy,
    "torch": as_torch,
    "old torch": lambda evil: as_torch(evil, _use_new_zipfile_serialization=False),
}


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("hostile_arrays")


@pytest.mark.bad_input
@pytest.mark.parametrize("loader", LOADERS)
@pytest.mark.parametrize("form", PICKLES)
def test_no_pickle_is_run(tmp_path: Path, loader: str, form: str) -> None:
    sign, path = tmp_path / "unpickled", tmp_path / "file"
    path.write_bytes(PICKLES[form](Evil(sign)))
    load, error = LOADERS[loader]
    with pytest.raises(error, match="file"):
        load(path)
    assert not sign.exists()
    pickle.loads(pickle.dumps(Evil(sign)))
    assert sign.exists()


def header(shape: str, descr: str = "'<f8'") -> bytes:
    """An npy file that says to hold an array, and holds 16 bytes."""
    text = f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n".encode()
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + bytes(16)


ABSURD = {
    "nothing": b"",
    "text": b"numbers",
    "petabytes": header("(10**15,)".replace("10**15", "1" + "0" * 15)),
    "more than can be counted": header("(" + "9" * 30 + ",)"),
    "negative": header("(-5,)"),
    "many dimensions": header("(" + "1," * 200 + ")"),
    "nested": header("(" * 90 + ")" * 90),
    "nested deep": header("[" * 3000 + "]" * 3000),
    "code": header("__import__('os').mkdir('x')"),
    "objects": header("(1,)", "'|O'"),
    "records of objects": header("(1,)", "[('a', '|O')]"),
    "no header": b"\x93NUMPY\x01\x00\xff\xff{",
}


@pytest.mark.bad_input
@pytest.mark.parametrize("loader", [name for name in LOADERS if name != "weights"])
@pytest.mark.parametrize("name", ABSURD)
def test_absurd_headers_are_refused(tmp_path: Path, loader: str, name: str) -> None:
    path = tmp_path / "file"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("numbers.npy", ABSURD[name])
    load, error = LOADERS[loader]
    with pytest.raises(error, match="file"):
        load(path)


@pytest.mark.bad_input
def test_a_zip_that_unpacks_to_too_much_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_arrays(tmp_path / "a.npz", "test", {"numbers": np.zeros(10**6)})
    monkeypatch.setattr(arrays_module, "MAX_ARRAYS_BYTES", 10**6)
    with pytest.raises(ArtifactError, match=r"a\.npz.*unpacks from [0-9,]+ to 8,000,[0-9]+ bytes"):
        load_arrays(tmp_path / "a.npz", "test", ("numbers",))


@pytest.mark.bad_input
def test_what_grows_too_much_or_is_something_else_is_not_unpacked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.npz"
    save_arrays(path, "test", {"numbers": np.zeros(10**6)})
    with monkeypatch.context() as smaller:
        smaller.setattr(arrays_module, "PLAIN_ARRAYS_BYTES", 10**6)
        with pytest.raises(ArtifactError, match="which no file of arrays does"):
            load_arrays(path, "test", ("numbers",))
    read: list[str] = []
    whole = np.lib.npyio.NpzFile.__getitem__

    def counted(file: Any, name: str) -> Any:
        read.append(name)
        return whole(file, name)

    monkeypatch.setattr(np.lib.npyio.NpzFile, "__getitem__", counted)
    for kind, names in (("other", ("numbers",)), ("test", ("numbers", "more"))):
        with pytest.raises(ArtifactError):
            load_arrays(path, kind, names)
    assert set(read) == {"kind"}


WEIGHTS: dict[str, Callable[[Any], Any]] = {
    "not finite": lambda torch: torch.full((2, 3), float("nan")),
    "whole numbers": lambda torch: torch.zeros(2, 3, dtype=torch.int64),
    "complex numbers": lambda torch: torch.zeros(2, 3, dtype=torch.complex64),
    "sparse": lambda torch: torch.zeros(2, 3).to_sparse(),
    "without storage": lambda torch: torch.empty(2, 3, device="meta"),
    "another shape": lambda torch: torch.zeros(3, 2),
    "a list": lambda torch: [[0.0] * 3] * 2,
    "text": lambda torch: "weights",
    "none": lambda torch: None,
}


@pytest.mark.bad_input
@pytest.mark.parametrize("name", WEIGHTS)
def test_weights_that_are_none_are_refused(tmp_path: Path, name: str) -> None:
    import torch

    torch.save({"features.0.weight": WEIGHTS[name](torch)}, tmp_path / "file")
    with pytest.raises(WeightsError, match="file"):
        load_weights(tmp_path / "file")


def read_damaged(folder: Path, mutations: list[Mutation]) -> None:
    """It is refused, or says what it said."""
    path, original = folder / "whole.npz", {"numbers": np.arange(50.0), "texts": np.array(["a", "bc"])}
    if not path.exists():
        save_arrays(path, "test", original)
    damaged = folder / "damaged.npz"
    damaged.write_bytes(mutated(path.read_bytes(), mutations))
    with suppress(ArtifactError):
        found = load_arrays(damaged, "test", tuple(original))
        assert all(np.array_equal(found[name], original[name]) for name in original)


@examples(FEW)
@given(mutations=MUTATIONS)
def test_fuzz_damaged_arrays(folder: Path, mutations: list[Mutation]) -> None:
    read_damaged(folder, mutations)


@pytest.mark.slow
@examples(MANY)
@given(mutations=MUTATIONS)
def test_fuzz_damaged_arrays_much(folder: Path, mutations: list[Mutation]) -> None:
    read_damaged(folder, mutations)


@examples(FEW)
@given(content=st.binary(max_size=200), loader=st.sampled_from(sorted(LOADERS)))
def test_fuzz_any_bytes(folder: Path, content: bytes, loader: str) -> None:
    (folder / "file").write_bytes(content)
    load, error = LOADERS[loader]
    with pytest.raises(error, match="file"):
        load(folder / "file")
