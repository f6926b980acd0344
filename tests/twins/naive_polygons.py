"""The obvious way from polygons to what changed of each, and back, on lists of tuples."""


def shortened(slots, polygons):
    """Give (head, tail, what is left) of each polygon."""
    before, found = {}, []
    for slot, polygon in zip(slots, polygons, strict=True):
        old = before.get(slot, [])
        most = min(len(old), len(polygon))
        head = max(n for n in range(most + 1) if old[:n] == polygon[:n])
        fit = range(most - head + 1)
        tail = max(n for n in fit if old[len(old) - n :] == polygon[len(polygon) - n :])
        found.append((head, tail, polygon[head : len(polygon) - tail]))
        before[slot] = polygon
    return found


def restored(slots, parts):
    """Give the polygons; None from the first one that leaves out more than there was."""
    before, found = {}, []
    for slot, (head, tail, new) in zip(slots, parts, strict=True):
        old = before.get(slot, [])
        if head < 0 or tail < 0 or head + tail > len(old):
            break
        before[slot] = old[:head] + new + old[len(old) - tail :]
        found.append(before[slot])
    return found


def leader(epochs, polygons, epoch, row):
    """Give the number of the last polygon, not of a later epoch, that a padded row shows."""
    for i in reversed(range(len(polygons))):
        padded = polygons[i] + polygons[i][-1:] * (len(row) - len(polygons[i]))
        if epochs[i] <= epoch and polygons[i] and padded == row:
            return i
    return -1
