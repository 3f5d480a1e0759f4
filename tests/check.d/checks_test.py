#!/usr/bin/env python3
"""The checks find what they are for. Run by tests/check before them."""
import os
import tempfile
import unittest

import links
import repository
import words


class Tree(unittest.TestCase):
    """A folder in place of the repository."""

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root, repository.ROOT = repository.ROOT, self.folder.name

    def tearDown(self):
        repository.ROOT = self.root
        self.folder.cleanup()

    def write(self, name, content):
        path = os.path.join(repository.ROOT, name)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, 'w', encoding='utf-8') as f:
            f.write(content)

    def lines_with_faults(self, content):
        self.write('docs/page.md', content)
        return [line for line, fault in links.check_page('docs/page.md', ['src/core/hash.h']) if fault]


class Links(Tree):
    def test_dead_links_and_anchors_are_found(self):
        self.write('docs/other.md', '# A heading, with `code` & more\n## Twice\n## Twice\n')
        page = ('[a](other.md) [b](other.md#a-heading-with-code--more) [c](other.md#twice-1) [d](https://x.org/y.md)\n'
                '[dead](gone.md)\n![dead](gone.png)\n[dead](other.md#twice-2)\n[dead](#nothing)\n')
        self.assertEqual(self.lines_with_faults(page), [2, 3, 4, 5])

    def test_links_in_code_are_none(self):
        self.assertEqual(self.lines_with_faults('`[a](gone.md)`\n```\n[a](gone.md)\n```\n'), [])

    def test_dead_paths_are_found(self):
        self.write('src/core/hash.h', '')
        page = ('`src/core/hash.h` `src/core/hash.h:12` `core/hash.h` `hash.{h}` `btSoftBody.h` `build/x/y.h`\n'
                '`src/core/gone.h`\n`gone.cpp`\n`src/core/{hash,gone}.h`\n`src/*/hash.h` `out/frame_NNNN.md` `tests/MODULE`\n')
        self.assertEqual(self.lines_with_faults(page), [2, 3, 4])

    def test_documents_named_in_comments_exist(self):
        self.write('docs/page.md', '')
        self.write('src/a.cpp', '// See docs/page.md.\n// See docs/gone.md.\n')
        self.assertEqual([line for line, fault in links.check_source('src/a.cpp') if fault], [2])


class Words(Tree):
    def lines(self, name, content):
        self.write(name, content)
        known = [(words.re.compile(r'\bwidget\b', words.re.I), 'gadget')]
        return [int(finding.split(':')[1]) for finding in words.findings(name, known)]

    def test_comments_are_searched_and_code_is_not(self):
        source = ('int widget = 1\'000;  // no\n// a widget\nconst char* s = "// widget";\nauto r = R"(\n// widget\n)";\n'
                  '/* one\n widget */ char c = \'"\';  /// Widget\n// `widget`\n')
        self.assertEqual(self.lines('src/a.cpp', source), [2, 8])

    def test_pages_are_searched_without_their_code(self):
        self.assertEqual(self.lines('docs/a.md', 'a `widget`\n```\nwidget\n```\nThe widget.\n'), [5])


if __name__ == '__main__':
    unittest.main(argv=['checks_test.py', '-q'])
