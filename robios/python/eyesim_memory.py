"""Texts and images as C takes them, whatever a program in Python has: arrays of ctypes or numpy, bytes, lists."""

import ctypes


def as_bytes(text):
    """A text as C takes it."""
    if text is None:
        return b""
    if isinstance(text, (bytes, bytearray)):
        return bytes(text)
    if isinstance(text, str):
        return text.encode("utf-8", "replace")
    if hasattr(text, "raw"):
        return text.value
    return str(text).encode("utf-8", "replace")


def pixels(image, count):
    """An image of at least `count` bytes."""
    if image is None:
        return None
    if isinstance(image, ctypes._Pointer):
        return ctypes.cast(image, ctypes.c_void_p)
    if isinstance(image, ctypes.Array) and ctypes.sizeof(image) >= count and _is_of_bytes(image):
        return image
    data = _data(image)
    return (ctypes.c_ubyte * max(count, len(data))).from_buffer_copy(data.ljust(count, b"\0"))


def _is_of_bytes(array):
    kind = type(array)
    while hasattr(kind, "_length_"):
        kind = kind._type_
    return ctypes.sizeof(kind) == 1


def _data(image):
    """An image's values in whole numbers, the lowest eight bits of each."""
    if hasattr(image, "astype"):
        # Of numpy: rows of any stride, numbers of any type. A negative number keeps its bits.
        image = image.astype("int64").astype("uint8")
    try:
        view = memoryview(image)
    except TypeError:
        if hasattr(image, "tobytes"):
            return image.tobytes()
        return bytes(int(value) & 0xFF for value in _flat(image))
    if view.itemsize == 1:
        return view.tobytes()
    return bytes(int(value) & 0xFF for value in _flat(image))


def _flat(values):
    for value in values:
        if hasattr(value, "__iter__"):
            yield from _flat(value)
        else:
            yield value


def filled(target, count, fill):
    """An image of `count` bytes that a function fills: a new one, or what a program has for it. Its memory is never
    exceeded."""
    room = (ctypes.c_ubyte * count)()
    fill(room)
    if target is None:
        return room
    if hasattr(target, "flat") and hasattr(target, "size"):
        target.flat[: min(count, target.size)] = list(room[: target.size])
    elif isinstance(target, ctypes._Pointer):
        ctypes.memmove(target, room, count)
    elif isinstance(target, list):
        target[:] = room
    else:
        view = memoryview(target).cast("B")
        length = min(count, len(view))
        view[:length] = bytes(room[:length])
    return target


def store(targets, values):
    """Values to where a program wants them: numbers of ctypes, or pointers to them."""
    for target, value in zip(targets, values):
        if hasattr(target, "contents"):
            target.contents.value = value
        elif hasattr(target, "_obj"):
            target._obj.value = value
        elif hasattr(target, "value"):
            target.value = value
