"""Arrays without reference counts, for compiled inner loops.

numba counts a reference (an atomic operation) wherever an array is passed or merged in the control flow; in the kernel
that took more than half of the time of a step.
"""

from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array


@intrinsic
def unowned(typingctx, array):
    """A view of `array` that keeps no reference; the caller keeps the array alive as long as the view is used."""

    def codegen(context, builder, signature, arguments):
        view = make_array(signature.args[0])(context, builder, value=arguments[0])
        view.meminfo = cgutils.get_null_value(view.meminfo.type)
        view.parent = cgutils.get_null_value(view.parent.type)
        return view._getvalue()

    return array(array), codegen
