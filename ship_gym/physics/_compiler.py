"""Two ways to compile with numba: a loop over ships, and the parts that are inlined into it.

numba's own way would compile and optimise each part by itself, with entry points from Python and C,
and only then put it into the loop: half of the time, and loops in parts would be vectorised before
it is known that arrays do not overlap. What follows uses numba's classes for own compilers
(``pipeline_class``) and what they call. Where a version of numba has them otherwise, as the first
compilation of a process tries (`works`), kernels are compiled the plain way: the same numbers,
slower. Tried with numba 0.61 to 0.68.
"""

from __future__ import annotations

import functools
import warnings
from typing import Any

import numba
import numpy as np

from ship_gym.physics._cache import one_at_a_time

WIDE = '"prefer-vector-width"="512"'  # where there are such registers; LLVM prefers half of them

try:
    from numba.core import types
    from numba.core.compiler import CompilerBase, DefaultPassBuilder, _LowerResult
    from numba.core.compiler_machinery import register_pass
    from numba.core.lowering import Lower
    from numba.core.typed_passes import NativeLowering

    class _WideLower(Lower):
        def setup_function(self, fndesc):
            super().setup_function(fndesc)
            set.add(self.function.attributes, WIDE)  # llvmlite's own `add` knows no such attribute

    @register_pass(mutates_CFG=True, analysis_only=False)
    class LoopLowering(NativeLowering):
        """Machine code of a loop: its arrays do not overlap, its vectors are as wide as can be."""

        _name = "ship_gym_loop_lowering"

        @property
        def lowering_class(self):
            return _WideLower

        def run_pass(self, state):
            state.flags.noalias = True
            return super().run_pass(state)

    def _simplify(library):
        """Optimise a part, but leave its loops as they are."""
        made = library._codegen._module_pass_manager(
            opt=2, loop_vectorize=False, slp_vectorize=False
        )
        # with a builder of passes from numba 0.62 on, before it the passes alone
        passes, *builder = made if isinstance(made, tuple) else (made,)
        passes.run(library._final_module, *builder)

    def _leave(library):
        """Leave a part that only calls others as it is: the loop that takes it in is optimised."""

    @register_pass(mutates_CFG=True, analysis_only=False)
    class PartLowering(NativeLowering):
        """Code of a part, for loops to take in: no vectors yet, no entry points."""

        _name = "ship_gym_part_lowering"

        def run_pass(self, state):
            flags, context = state.flags, state.targetctx
            flags.no_compile = flags.no_cpython_wrapper = flags.no_cfunc_wrapper = True
            state.library = context.codegen().create_library(state.func_id.func_qualname)
            composed = getattr(state.func_id.func, "composed", False)
            simplify = _leave if composed else _simplify
            state.library._optimize_final_module = functools.partial(simplify, state.library)
            super().run_pass(state)
            made, key = state["cr"], object()  # numba finds a compiled function by such a key
            context.insert_user_function(key, made.fndesc, [state.library])
            state["cr"] = _LowerResult(made.fndesc, made.call_helper, cfunc=key, env=made.env)
            return True

    def _compiler(name: str, lowering: type) -> type:
        def define_pipelines(self):
            pipeline = DefaultPassBuilder.define_nopython_pipeline(self.state)
            if not works():
                return [pipeline]
            pipeline.passes = [
                (lowering if one is NativeLowering else one, text) for one, text in pipeline.passes
            ]
            pipeline._finalized = False
            pipeline.finalize()
            return [pipeline]

        return type(name, (CompilerBase,), {"define_pipelines": define_pipelines})

    LOOP: dict[str, Any] = {"pipeline_class": _compiler("LoopCompiler", LoopLowering)}
    PART: dict[str, Any] = {"pipeline_class": _compiler("PartCompiler", PartLowering)}
    WORKS = True
except (ImportError, AttributeError):
    LOOP, PART, WORKS = {}, {}, False


_found: bool | None = None if WORKS else False  # of `works`, once it has been asked


def works() -> bool:
    """Whether this numba compiles a loop with a part in it by our ways, and rightly.

    Asked by the first compilation of a process, so that one which finds all kept does not pay.
    """
    global _found
    if _found is None:
        _found = True  # while it is tried
        try:
            _found = bool(_tried_loop()(np.arange(9.0)) == 72.0)
        except Exception:  # whatever another version of numba raises
            _found = False
    return _found


def _tried_loop() -> Any:
    """A loop over an array, with a part of either kind."""

    def doubled(x):
        return 2.0 * x

    def passed_on(x):
        return twice(x)

    def summed(values):
        total = 0.0
        for i in range(len(values)):
            total += through(values[i])
        return total

    passed_on.__dict__["composed"] = True
    options = {"error_model": "numpy", "_nrt": False}
    twice, through = (
        keep_part(numba.njit(part, forceinline=True, **options, **PART))
        for part in (doubled, passed_on)
    )
    return numba.njit(summed, **options, **LOOP)


saved: list[str] = []  # functions that this process has compiled, and whose code it has kept


def keep_code(function: Any) -> Any:
    """Change how a dispatcher loads and saves the machine code that it keeps.

    Loading does without what numba imports in order to compile: half of the time to the first step
    of a process for which all is kept. Saving is for one process at a time: two that compile a
    function for other types at once would take the same file (numba reads the index, adds to it and
    writes it), and one would later run the code of the other. Code that cannot be saved, as on a
    full disk, serves this process all the same.
    """
    cache: Any = getattr(function, "_cache", None)
    if not (WORKS and hasattr(cache, "_load_overload") and hasattr(cache, "cache_path")):
        return function
    save = cache.save_overload

    def load_overload(signature, context):
        with cache._guard_against_spurious_io_errors():
            return cache._load_overload(signature, context)

    def save_overload(signature, made):
        try:
            with one_at_a_time(cache.cache_path):
                save(signature, made)
        except OSError as error:
            text = f"compiled code cannot be kept in {cache.cache_path}, so that others wait again"
            warnings.warn(f"{text}: {error}", RuntimeWarning, stacklevel=2)
            return
        saved.append(function.py_func.__qualname__)

    cache.load_overload, cache.save_overload = load_overload, save_overload
    return function


def keep_part(part: Any) -> Any:
    """Make a dispatcher of a part keep what it compiled, which nothing can call from Python.

    And make it compile one version for all numbers that a caller writes out, not one for each.
    """

    def add_overload(made):
        part.overloads[tuple(made.signature.args)] = made

    def get_call_template(args, kws):
        args = tuple(types.unliteral(arg) for arg in args)
        return type(part).get_call_template(part, args, kws)

    if WORKS:
        part.add_overload = add_overload
        part.get_call_template = get_call_template
    return part
