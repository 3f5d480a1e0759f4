#!/usr/bin/env python3
"""Words that comments and documents do not use, and what to write instead: words.txt beside this file."""
import os
import re
import sys

import repository


def rules():
    """Pairs of a pattern and a replacement, from lines `pattern<tab>replacement`."""
    with open(os.path.join(os.path.dirname(__file__), 'words.txt'), encoding='utf-8') as f:
        for line in f:
            if line.strip() and not line.startswith('#'):
                pattern, instead = line.rstrip('\n').split('\t')
                yield re.compile(pattern, re.I), instead


def findings(name, known):
    for number, line in enumerate(repository.prose(name).split('\n'), 1):
        for pattern, instead in known:
            match = pattern.search(line)
            if match:
                yield f'{name}:{number}: "{match.group()}": write {instead}'


def main():
    known = list(rules())
    found = [f for name in repository.files('.h', '.cpp', '.md') for f in findings(name, known)]
    print('\n'.join(found), end='\n' if found else '')
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
