#!/usr/bin/env python3
"""tidy.py [--since REV] [--deep]: clang-tidy on every source of src, bullet_adapter and demos that the preset `tests` builds.

A file that had no warning is skipped until it, a file of ours that it includes, its compile command or .clang-tidy
changes. The marks of clean files lie in build/tidy. With --since only files that the changes since REV reach.

Most of the time of a check goes into the headers of Eigen, Bullet and the standard library. Files with one compile
command are therefore checked together, as one source that includes them. A file that is built for single and for
double precision is checked with its first command.

The static analyzer follows calls of small functions alone (its mode `shallow`). With --deep it follows all, which takes
twice as long."""
import argparse
import concurrent.futures
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile

import repository

INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.M)
PLACES = ('src', 'bullet_adapter', 'demos')
GROUP = 8
# Names that a file declares for itself, at the start of a line: two files with one such name cannot be one source.
PRIVATE = re.compile(r'^namespace {$(.*?)^}  // namespace$', re.M | re.S)
DECLARED = re.compile(r'^(?:struct|class|enum class|using) (\w+)|^(?! )[\w:<>,&* ]*?[ &*](\w+)(?:\[\w*\])*(?: = |\{|;|\()', re.M)
# The clang static analyzer follows the paths of functions in an included source only below a file of this name.
UNIFIED = 'UnifiedSource.cpp'


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
                self.folder = entry['directory']

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

    def flags(self, name):
        """The compile command without the file and its object."""
        command = self.commands[name][0]
        return re.sub(r' (-o|-MF|-MT) \S+| -c \S+', '', command)

    def names(self, name):
        """The names that the file declares in an unnamed namespace, and `main`."""
        text = repository.text(name)
        found = {a or b for part in PRIVATE.findall(text) for a, b in DECLARED.findall(part)}
        return found | ({'main'} if re.search(r'^int main\(', text, re.M) else set())

    def groups(self, names):
        """Up to GROUP files each, with one compile command and no name in common."""
        found = []
        for name in names:
            flags, own = self.flags(name), self.names(name)
            for group in found:
                if group['flags'] == flags and len(group['files']) < GROUP and not group['names'] & own:
                    break
            else:
                group = {'flags': flags, 'files': [], 'names': set()}
                found.append(group)
            group['files'].append(name)
            group['names'] |= own
        return [group['files'] for group in found]


def changed_since(revision):
    names = subprocess.run(['git', 'diff', '--merge-base', '--name-only', revision, '--'], cwd=repository.ROOT, check=True,
                           capture_output=True, text=True).stdout.split()
    new = subprocess.run(['git', 'ls-files', '--others', '--exclude-standard'], cwd=repository.ROOT, check=True,
                         capture_output=True, text=True).stdout.split()
    return set(names + new)


def run_tidy(files, sources, depth):
    """The warnings of files that are checked as one source. Files that do not compile together are checked by halves."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, UNIFIED)
        with open(path, 'w', encoding='utf-8') as out:
            out.writelines(f'#include "{os.path.join(repository.ROOT, name)}"\n' for name in files)
        command = f'{sources.flags(files[0])} -Xclang -analyzer-config -Xclang mode={depth} -c {path}'
        with open(os.path.join(folder, 'compile_commands.json'), 'w', encoding='utf-8') as out:
            json.dump([{'directory': sources.folder, 'command': command, 'file': path}], out)
        done = subprocess.run(['clang-tidy', '--quiet', '-p', folder, '--checks=-bugprone-suspicious-include',
                               '--config-file=' + os.path.join(repository.ROOT, '.clang-tidy'),
                               '--header-filter=(src|bullet_adapter|demos)/.*\\.(h|cpp)$', path],
                              cwd=repository.ROOT, capture_output=True, text=True)
    output = done.stdout + done.stderr if done.returncode or re.search(r'(warning|error): ', done.stdout) else ''
    if '[clang-diagnostic-error' in output and len(files) > 1:
        half = len(files) // 2
        return run_tidy(files[:half], sources, depth) + run_tidy(files[half:], sources, depth)
    return output


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--since', metavar='REV')
    parser.add_argument('--deep', action='store_true')
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
    depth = 'deep' if options.deep else 'shallow'
    salt = depth.encode() + tool.encode() + repository.text('.clang-tidy').encode()
    paths = {n: os.path.join(marks, sources.mark(n, salt)) for n in names}
    todo = [n for n in names if not os.path.exists(paths[n])]
    print(f'clang-tidy: {len(todo)} of {len(sources.commands)} files to check', flush=True)

    faulty = 0
    groups = sources.groups(todo)
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for files, warnings in zip(groups, pool.map(lambda files: run_tidy(files, sources, depth), groups)):
            if warnings:
                faulty += 1
                print(f'{" ".join(files)}:\n{warnings}', flush=True)
            else:
                for name in files:
                    open(paths[name], 'w', encoding='utf-8').close()
    return 1 if faulty else 0


if __name__ == '__main__':
    sys.exit(main())
