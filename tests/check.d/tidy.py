#!/usr/bin/env python3
"""tidy.py [--since REV]: clang-tidy on every source of src, bullet_adapter and demos that the preset `tests` builds.

A file that had no warning is skipped until it, a file of ours that it includes, its compile command or .clang-tidy
changes. The marks of clean files lie in build/tidy. With --since only files that the changes since REV reach."""
import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys

import repository

INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
PLACES = ('src', 'bullet_adapter', 'demos')


class Sources:
    """The sources of a compile database with what they include of ours."""

    def __init__(self, database):
        self.commands = {}
        self.known = set(repository.files('.h', '.cpp'))
        self.direct = {}
        for entry in json.load(open(database, encoding='utf-8')):
            name = os.path.relpath(os.path.join(entry['directory'], entry['file']), repository.ROOT)
            if name.startswith(tuple(place + '/' for place in PLACES)):
                self.commands.setdefault(name, []).append(entry['command'])

    def includes(self, name):
        """What a file includes directly: beside it, or below one of our include folders."""
        if name not in self.direct:
            folders = {os.path.dirname(name), 'src', 'bullet_adapter', 'demos', 'demos/app'}
            folders |= set(re.findall(re.escape('-I' + repository.ROOT) + r'/(\S+)', ' '.join(self.commands.get(name, []))))
            targets = INCLUDE.findall(repository.text(name))
            paths = {os.path.normpath(os.path.join(folder, t)) for folder in folders for t in targets}
            self.direct[name] = paths & self.known
        return self.direct[name]

    def reach(self, name):
        """The file and everything of ours that it includes, directly or not."""
        found, todo = set(), [name]
        while todo:
            one = todo.pop()
            if one not in found:
                found.add(one)
                todo += self.includes(one)
        return found

    def mark(self, name, salt):
        """Changes when a check of the file may have another result."""
        digest = hashlib.sha256(salt)
        for part in sorted(self.reach(name)):
            digest.update(part.encode() + b'\0' + repository.text(part).encode())
        digest.update('\n'.join(sorted(self.commands[name])).replace(repository.ROOT, '.').encode())
        return digest.hexdigest()


def changed_since(revision):
    names = subprocess.run(['git', 'diff', '--merge-base', '--name-only', revision, '--'], cwd=repository.ROOT, check=True,
                           capture_output=True, text=True).stdout.split()
    new = subprocess.run(['git', 'ls-files', '--others', '--exclude-standard'], cwd=repository.ROOT, check=True,
                         capture_output=True, text=True).stdout.split()
    return set(names + new)


def run_tidy(name, database, mark):
    """The warnings of one file, or why it could not be read; writes the mark and is empty when clean."""
    done = subprocess.run(['clang-tidy', '--quiet', '-p', os.path.dirname(database), name], cwd=repository.ROOT,
                          capture_output=True, text=True)
    if done.returncode == 0 and not re.search(r'(warning|error): ', done.stdout):
        open(mark, 'w', encoding='utf-8').close()
        return ''
    return done.stdout + done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--since', metavar='REV')
    parser.add_argument('--database', default=os.path.join(repository.ROOT, 'build/tests/compile_commands.json'))
    options = parser.parse_args()

    tool = subprocess.run(['clang-tidy', '--version'], check=True, capture_output=True, text=True).stdout
    if 'version 14.' not in tool:
        sys.exit('clang-tidy 14 is needed:\n' + tool)
    marks = os.path.join(repository.ROOT, 'build/tidy')
    os.makedirs(marks, exist_ok=True)
    sources = Sources(options.database)
    names = sorted(sources.commands)
    if options.since:
        changed = changed_since(options.since)
        names = [n for n in names if '.clang-tidy' in changed or sources.reach(n) & changed]
    salt = tool.encode() + repository.text('.clang-tidy').encode()
    paths = {n: os.path.join(marks, sources.mark(n, salt)) for n in names}
    todo = [n for n in names if not os.path.exists(paths[n])]
    print(f'clang-tidy: {len(todo)} of {len(sources.commands)} files to check', flush=True)

    faulty = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        checks = pool.map(lambda n: run_tidy(n, options.database, paths[n]), todo)
        for name, warnings in zip(todo, checks):
            if warnings:
                faulty += 1
                print(f'{name}:\n{warnings}', flush=True)
    return 1 if faulty else 0


if __name__ == '__main__':
    sys.exit(main())
