"""Sets of nodes as bits: a floor of 50 000 m² has half a milliard of them."""

from dataclasses import dataclass

import numpy as np

from satAOI_geo.kernels import helper
from satAOI_geo.lattice import WORD_BITS, Words
from satAOI_geo.plan import BoolArray

ONE = np.uint64(1)
TOP = np.uint64(WORD_BITS - 1)


@dataclass(frozen=True, slots=True, eq=False)
class Nodes:
    """A set of nodes of a lattice, or of a window of it.

    Attributes:
        words: Shape (n_rows, n_words), see `lattice.Words`; bits beyond the last column are clear.
        n_columns: Columns of the lattice.
    """

    words: Words
    n_columns: int

    @classmethod
    def of(cls, chosen: BoolArray) -> "Nodes":
        """The set of the nodes that are True, shape (n_rows, n_columns)."""
        n_rows, n_columns = chosen.shape
        octets = np.packbits(chosen, axis=-1, bitorder="little")
        padded = np.zeros((n_rows, -(-n_columns // WORD_BITS) * WORD_BITS // 8), dtype=np.uint8)
        padded[:, : octets.shape[1]] = octets
        return cls(padded.view("<u8").astype(np.uint64), n_columns)

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, columns)."""
        return self.words.shape[0], self.n_columns

    def window(self, rows: slice, columns: slice) -> "Nodes":
        """Those in a window, with start and stop; see `Lattice.around` for its columns."""
        words = self.words[rows, columns.start // WORD_BITS : -(-columns.stop // WORD_BITS)]
        return Nodes(words, columns.stop - columns.start)

    def count(self) -> int:
        """How many nodes there are."""
        return int(np.bitwise_count(self.words).sum())

    def has(self, iy: int, ix: int) -> bool:
        """Whether a node of the lattice is in the set."""
        return bool(int(self.words[iy, ix // WORD_BITS]) >> int(ix) % WORD_BITS & 1)

    def as_array(self) -> BoolArray:
        """Whether each node is in the set, shape (n_rows, n_columns)."""
        octets = np.ascontiguousarray(self.words, dtype="<u8").view(np.uint8)
        bits = np.unpackbits(octets, axis=-1, count=self.n_columns, bitorder="little")
        return bits.view(np.bool_)


def from_right(words: Words) -> Words:
    """Each node's bit becomes that of its right neighbour."""
    shifted: Words = words >> ONE
    shifted[:, :-1] |= words[:, 1:] << TOP
    return shifted


def from_left(words: Words) -> Words:
    """Each node's bit becomes that of its left neighbour."""
    shifted: Words = words << ONE
    shifted[:, 1:] |= words[:, :-1] >> TOP
    return shifted


def from_above(words: Words) -> Words:
    """Each node's bit becomes that of its upper neighbour."""
    shifted = np.zeros_like(words)
    shifted[:-1] = words[1:]
    return shifted


def from_below(words: Words) -> Words:
    """Each node's bit becomes that of its lower neighbour."""
    shifted = np.zeros_like(words)
    shifted[1:] = words[:-1]
    return shifted


@helper
def n_bits(bits: np.uint64) -> int:
    """Number of set bits, summed in pairs, nibbles and octets."""
    bits -= bits >> np.uint64(1) & np.uint64(0x5555555555555555)
    bits = (bits & np.uint64(0x3333333333333333)) + (
        bits >> np.uint64(2) & np.uint64(0x3333333333333333)
    )
    bits = bits + (bits >> np.uint64(4)) & np.uint64(0x0F0F0F0F0F0F0F0F)
    return int(bits * np.uint64(0x0101010101010101) >> np.uint64(56))


@helper
def lowest_bit(bits: np.uint64) -> int:
    """Number of the lowest set bit: how many lie below it."""
    return n_bits((bits & (~bits + np.uint64(1))) - np.uint64(1))


@helper
def set_bits(row: Words, begin: int, end: int) -> None:
    """Set bits begin .. end of a row of words."""
    every = np.uint64(0xFFFFFFFFFFFFFFFF)
    first_word, last_word = begin >> 6, end >> 6
    first_mask = every << np.uint64(begin & 63)
    last_mask = every >> np.uint64(63 - (end & 63))
    if first_word == last_word:
        row[first_word] |= first_mask & last_mask
        return
    row[first_word] |= first_mask
    for word in range(first_word + 1, last_word):
        row[word] = every
    row[last_word] |= last_mask
