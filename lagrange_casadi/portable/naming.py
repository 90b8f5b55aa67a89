"""Names of a mechanism as names in C: no keyword of C or C++, no macro of their libraries, and no two alike."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping, Sequence
from importlib import resources

_KEYWORDS = frozenset(
    """
    alignas alignof and and_eq asm auto bitand bitor bool break case catch char char8_t char16_t char32_t class compl concept const
    consteval constexpr constinit const_cast continue co_await co_return co_yield decltype default delete do double dynamic_cast
    else enum explicit export extern false float for friend goto if inline int long mutable namespace new noexcept not not_eq
    nullptr operator or or_eq private protected public register reinterpret_cast requires restrict return short signed sizeof static
    static_assert static_cast struct switch template this thread_local throw true try typedef typeid typename typeof typeof_unqual
    union unsigned using virtual void volatile wchar_t while xor xor_eq
    I NAN INFINITY HUGE_VAL NULL EOF BUFSIZ DOMAIN SING OVERFLOW UNDERFLOW PLOSS TLOSS errno signal assert math_errhandling
    isfinite isinf isnan isnormal signbit fpclassify min max
    SEAL GUID PARAMETERS VALUES INPUTS OUTPUTS TIMED TURN INSTANTIATED INITIALIZING RUNNING TERMINATED LISTED INSTANTS STEPS LINKS
    RATIOS
    """.split()  # noqa: SIM905
)
"""Words of C and C++, and what the files of an export define."""

_FILES = frozenset(
    """
    all build clean continuous edit_cache example experimental fmu help install list_install_components make mex nightly package
    package_source preinstall rebuild_cache selftest test
    all_build install_local run_tests zero_check
    asan atomic c crypt dl gcc gcc_s m mvec nsl pthread resolv rt stdc util z
    debug general optimized
    aio arpa assert complex conio cpio crtdbg ctype direct dirent dlfcn dos errno excpt fcntl features fenv float fmtmsg fnmatch
    ftw glob grp iconv inttypes io iso646 langinfo libgen limits locale malloc math matrix memory monetary mqueue ndbm net netdb
    netinet nl_types poll process pwd regex sched search semaphore setjmp share signal spawn stdalign stdarg stdatomic stdbit
    stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string strings stropts sys syslog tar tchar termios tgmath threads
    time trace uchar ulimit unistd utime utmpx values varargs wchar wctype windows winsock wordexp
    algorithm array cmath cstdio vector
    aux con conerr conin conout nul prn
    com0 com1 com2 com3 com4 com5 com6 com7 com8 com9 lpt0 lpt1 lpt2 lpt3 lpt4 lpt5 lpt6 lpt7 lpt8 lpt9
    """.split()  # noqa: SIM905
)
"""What CMake, linkers, the C library, Windows or the folder itself call a target, a library, a header, a device or a file."""

_CMAKE = frozenset(
    """
    ALIAS AND ARCHIVE BUNDLE CMAKE CODE COMMAND COMPATIBILITY COMPONENT CONFIGURATIONS CONTENT CPACK CTEST DEFINED DESCRIPTION
    DESTINATION DIRECTORY ENV EQUAL EXCLUDE_FROM_ALL EXISTS EXPORT FALSE FILES FILE_SET FRAMEWORK GLOBAL HOMEPAGE_URL IF IGNORE
    IMPORTED INCLUDES INTERFACE LANGUAGES LIBRARY LINK_INTERFACE_LIBRARIES LINK_PRIVATE LINK_PUBLIC MATCHES MODULE N NAME
    NAMELINK_ONLY NAMELINK_SKIP NAMESPACE NO NONE NOT NOTFOUND OBJECT OBJECTS OFF ON OPTIONAL OR PERMISSIONS PRIVATE PRIVATE_HEADER
    PROGRAMS PROJECT PROPERTIES PUBLIC PUBLIC_HEADER QUIET REQUIRED RESOURCE RUNTIME SCRIPT SHARED STATIC STREQUAL TARGET TARGETS
    TRUE TYPE UNKNOWN VERSION VERSION_MAJOR WIN32 Y YES
    """.split()  # noqa: SIM905
)
"""Words of CMake's commands."""


@functools.cache
def _macros() -> frozenset[str]:
    """Names that headers replace."""
    text = (resources.files(__package__) / "templates" / "reserved.txt").read_text()
    return frozenset(word for line in text.splitlines() if not line.startswith("#") for word in line.split())


def reserved(word: str) -> bool:
    """Whether a name is taken in C, C++ or the headers of their libraries."""
    return word in _KEYWORDS or word in _macros()


def prefix(name: str) -> str:
    """What all files, symbols and targets of a mechanism begin with: its name, with underscores for what C does not allow."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_") or "mechanism"
    word = word if word[0].isalpha() else f"mechanism_{word}"
    return f"{word}_mechanism" if word.lower() in _FILES or word in _CMAKE or reserved(word) else word


def members(names: Mapping[str, str]) -> dict[str, str]:
    """Members of one struct for full names and what each is to be called, with underscores for colons.

    Where two would be alike, the later one is numbered.
    """
    found: dict[str, str] = {}
    taken: set[str] = set()
    for full, name in names.items():
        plain = re.sub(r"\W", "_", name)
        word = f"{plain}_" if reserved(plain) else plain
        number = 2
        while word in taken:
            word, number = f"{plain}_{number}", number + 1
        taken.add(word)
        found[full] = word
    return found


def constants(begin: str, links: Sequence[str]) -> dict[str, str]:
    """Constants for names that may differ in capitals alone; where two would be alike, the later one is numbered."""
    found: dict[str, str] = {}
    for link in links:
        word, number = f"{begin}_{link}".upper(), 2
        while word in found.values():
            word, number = f"{begin}_{link}_{number}".upper(), number + 1
        found[link] = word
    return found
