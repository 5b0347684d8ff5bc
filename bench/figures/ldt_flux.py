#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flux of EULUMDAT and IES files by the rule of the trade, with a reader that shares no line with Lucerna's.
Usage: ldt_flux.py FILE...   prints file, flux in lm, and what the file states."""
import math
import sys


def ring_sum(gammas, rings):
    """Per band of two gammas the mean of the two ring means times 2 pi (cos g1 - cos g2)."""
    return sum(0.5 * (rings[i] + rings[i + 1]) * 2 * math.pi
               * (math.cos(math.radians(gammas[i])) - math.cos(math.radians(gammas[i + 1])))
               for i in range(len(gammas) - 1))


def ldt(lines):
    isym, mc, ng = int(lines[2]), int(lines[3]), int(lines[5])
    sets = int(lines[25])
    stated = float(lines[28]) * float(lines[22]) / 100
    at = 26 + 6 * sets + 10
    values = [float(x.replace(',', '.')) for x in lines[at:] if x.strip()]
    gammas, cd = values[mc:mc + ng], values[mc + ng:]
    planes = [cd[i * ng:(i + 1) * ng] for i in range(len(cd) // ng)]
    # Stored planes: all, one, or halves and quarters with both end planes.
    weight = {0: [1] * mc, 1: [1]}.get(isym, [1] + [2] * (len(planes) - 2) + [1])
    rings = [sum(w * p[g] for w, p in zip(weight, planes)) / sum(weight) for g in range(ng)]
    return ring_sum(gammas, rings) * float(lines[28]) / 1000 * float(lines[23]), stated


def ies(lines):
    start = next(i for i, line in enumerate(lines) if line.startswith('TILT='))
    words = [float(w) for w in ' '.join(lines[start + 1:]).replace(',', ' ').split()]
    factor, nv, nh = words[2] * words[10], int(words[3]), int(words[4])
    v, h, cd = words[13:13 + nv], words[13 + nv:13 + nv + nh], words[13 + nv + nh:]
    planes = [cd[i * nv:(i + 1) * nv] for i in range(nh)]
    gaps = [h[i + 1] - h[i] for i in range(nh - 1)]
    weight = [1] if nh == 1 else [(gaps[i - 1] if i else 0) + (gaps[i] if i < nh - 1 else 0) for i in range(nh)]
    rings = [sum(w * p[g] for w, p in zip(weight, planes)) / sum(weight) for g in range(nv)]
    return ring_sum(v, rings) * factor, None


for name in sys.argv[1:]:
    text = open(name, encoding='latin-1').read().splitlines()
    flux, stated = (ldt if name.lower().endswith('.ldt') else ies)(text)
    print(f'{name}: {flux:.4f} lm' + (f', stated {stated:.4f} lm' if stated else ''))
