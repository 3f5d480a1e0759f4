#!/usr/bin/env python3
"""Links, anchors and paths in documents, and documents that comments name, must exist."""
import glob
import os
import re
import sys
import unicodedata

import repository

LINK = re.compile(r'!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?(?:\s+"[^"]*")?\s*\)')
SPAN = re.compile(r'`([^`\n]+)`')
FENCE = re.compile(r'^( *)(```|~~~).*?^ *\2', re.S | re.M)
TOP = ('src/', 'bullet_adapter/', 'demos/', 'tests/', 'docs/', '.ci/', '.github/')
SOURCE = re.compile(r'[\w.-]+(/[\w.-]+)*\.(h|cpp|py|cmake|md)')
FOREIGN = ('bt', 'Bullet', 'LinearMath/', 'fcl/', 'Eigen/', 'build/', 'out/')


def slug(heading):
    """The anchor that GitHub gives a heading."""
    heading = re.sub(r'!?\[([^\]]*)\]\([^)]*\)', r'\1', heading).replace('`', '').strip().lower()
    kept = [c for c in heading if c in ' -_' or unicodedata.category(c)[0] in 'LN' or unicodedata.category(c) == 'Mn']
    return ''.join(kept).replace(' ', '-')


def anchors(page):
    content = FENCE.sub('', repository.text(page))
    seen = {}
    for heading in re.findall(r'^#+ +(.*?) *#*$', content, re.M):
        name = slug(heading)
        seen[name] = seen.get(name, -1) + 1
        yield name if seen[name] == 0 else f'{name}-{seen[name]}'
    yield from re.findall(r'<a (?:id|name)="([^"]+)"', content)


def bad_link(page, target):
    """What is wrong with a link of a page; empty if nothing is, or if it leads out of the repository."""
    if re.match(r'[a-z]+:', target):
        return ''
    path, _, anchor = target.partition('#')
    full = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
    if not os.path.exists(os.path.join(repository.ROOT, full)):
        return f'no file {full}'
    if anchor and full.endswith('.md') and anchor not in anchors(full):
        return f'no heading #{anchor} in {full}'
    return ''


def expand(path):
    """`a/{b,c}.h` is two paths."""
    match = re.search(r'\{([^{}]*,[^{}]*)\}', path)
    if not match:
        return [path]
    return [p for part in match.group(1).split(',') for p in expand(path[:match.start()] + part + path[match.end():])]


def bad_path(span, known):
    """What is wrong with a text in backticks that looks like a path of this repository."""
    span = re.sub(r':\d+(-\d+)?$', '', span.strip())
    if re.search(r'[\s<>…$]|NNNN|(^|/)[A-Z]+(/|$)', span):
        return ''
    for path in expand(span):
        if path.startswith(TOP):
            if not glob.glob(os.path.join(repository.ROOT, path)):
                return f'no file {path}'
        elif SOURCE.fullmatch(path) and not path.startswith(FOREIGN):
            if not any(('/' + name).endswith('/' + path) for name in known):
                return f'no file ends in {path}'
    return ''


def line_of(content, position):
    return content.count('\n', 0, position) + 1


def check_page(page, known):
    content = repository.text(page)
    plain = FENCE.sub(lambda m: repository.blank(m.group()), content)
    for match in LINK.finditer(SPAN.sub(lambda m: repository.blank(m.group()), plain)):
        yield line_of(content, match.start()), bad_link(page, match.group(1))
    if page == 'CHANGELOG.md':  # names what there was
        return
    for match in SPAN.finditer(plain):
        yield line_of(content, match.start()), bad_path(match.group(1), known)


def check_source(name):
    """Documents that a source file, a build script or a program's message names."""
    content = repository.text(name)
    for match in re.finditer(r'(?<![\w/.-])docs/[\w./-]*\w', content):
        found = os.path.exists(os.path.join(repository.ROOT, match.group()))
        yield line_of(content, match.start()), '' if found else f'no file {match.group()}'


def main():
    known = repository.files()
    found = [f'{page}:{line}: {fault}' for page in repository.files('.md')
             for line, fault in check_page(page, known) if fault]
    sources = ('.h', '.cpp', '.txt', '.cmake', '.in', '.py', '.sh', '.yml', 'run', 'check')
    found += [f'{name}:{line}: {fault}' for name in repository.files(*sources)
              if name != 'tests/check.d/checks_test.py' for line, fault in check_source(name) if fault]
    print('\n'.join(found), end='\n' if found else '')
    return 1 if found else 0


if __name__ == '__main__':
    sys.exit(main())
