#!/usr/bin/env python3
"""page_test.py SITE [FOLDER]: the web page in Chromium without a window, with mouse and keys as a user has them.

SITE is what demos/web/build makes. Pictures go to FOLDER, if there is one."""
import base64
import functools
import http.server
import json
import os
import re
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import urllib.request

import websocket

SITE = sys.argv[1]
PICTURES = sys.argv[2] if len(sys.argv) > 2 else None
PATIENCE = 240  # [s]


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *arguments):
        pass


def serve():
    server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), functools.partial(Quiet, directory=SITE))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return server


class Browser:
    """Chromium, driven through its DevTools protocol."""

    def __init__(self, address):
        # Chromium's helpers may still write there for a moment after it has ended.
        self.profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        options = ['--headless=new', '--no-first-run', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
                   '--window-size=1360,860', '--hide-scrollbars', '--remote-debugging-port=0',
                   '--remote-allow-origins=*', '--user-data-dir=' + self.profile.name]
        if os.geteuid() == 0:
            options.append('--no-sandbox')
        self.process = subprocess.Popen(['chromium', *options, 'about:blank'], stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        port = self.wait_for(self.port)
        pages = json.load(urllib.request.urlopen(f'http://127.0.0.1:{port}/json'))
        target = next(p for p in pages if p['type'] == 'page')
        self.socket = websocket.create_connection(target['webSocketDebuggerUrl'], timeout=PATIENCE)
        self.number = 0
        self.errors = []
        for domain in ('Page', 'Runtime', 'Log'):
            self.call(domain + '.enable')
        self.call('Page.navigate', url=address)

    def port(self):
        try:
            with open(os.path.join(self.profile.name, 'DevToolsActivePort')) as file:
                return file.readline().strip()
        except FileNotFoundError:
            return None

    def call(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({'id': self.number, 'method': method, 'params': parameters}))
        while True:
            message = json.loads(self.socket.recv())
            if message.get('method') == 'Runtime.exceptionThrown':
                self.errors.append(message['params']['exceptionDetails'])
            if message.get('method') == 'Log.entryAdded' and message['params']['entry']['level'] == 'error':
                self.errors.append(message['params']['entry'])
            if message.get('id') == self.number:
                if 'error' in message:
                    raise RuntimeError(method + ': ' + message['error']['message'])
                return message['result']

    def value(self, expression):
        return self.call('Runtime.evaluate', expression=expression, returnByValue=True)['result'].get('value')

    def text(self, name):
        return self.value(f"document.getElementById('{name}').textContent")

    def number_in(self, name):
        return int(re.sub(r'\D', '', self.text(name)))

    @staticmethod
    def wait_for(condition, patience=PATIENCE):
        end = time.monotonic() + patience
        while time.monotonic() < end:
            found = condition()
            if found:
                return found
            time.sleep(0.1)
        raise TimeoutError('waited %d s' % patience)

    def wait_for_steps(self, count):
        self.wait_for(lambda: self.number_in('steps') >= count)

    def centre(self, name):
        return self.value(f"(b => [b.left + b.width / 2, b.top + b.height / 2])"
                          f"(document.getElementById('{name}').getBoundingClientRect())")

    def mouse(self, kind, at, button='none', buttons=0, **more):
        self.call('Input.dispatchMouseEvent', type=kind, x=at[0], y=at[1], button=button, buttons=buttons,
                  clickCount=1 if kind in ('mousePressed', 'mouseReleased') else 0, **more)

    def click(self, name):
        at = self.centre(name)
        self.mouse('mousePressed', at, 'left', 1)
        self.mouse('mouseReleased', at, 'left')

    def drag(self, start, end, button='left', hold=0.0):
        held = {'left': 1, 'right': 2}[button]
        self.mouse('mouseMoved', start)
        self.mouse('mousePressed', start, button, held)
        for k in range(1, 6):
            self.mouse('mouseMoved', [s + (e - s) * k / 5 for s, e in zip(start, end)], button, held)
        time.sleep(hold)
        self.mouse('mouseReleased', end, button)

    def key(self, key):
        code = {' ': 'Space'}.get(key, 'Key' + key.upper())
        for kind in ('keyDown', 'keyUp'):
            self.call('Input.dispatchKeyEvent', type=kind, key=key, code=code, text=key if kind == 'keyDown' else '')

    def picture(self, name=None):
        time.sleep(0.5)  # two frames of the page
        data = base64.b64decode(self.call('Page.captureScreenshot', format='png')['data'])
        if PICTURES and name:
            os.makedirs(PICTURES, exist_ok=True)
            with open(os.path.join(PICTURES, name + '.png'), 'wb') as file:
                file.write(data)
        return data

    def close(self):
        self.socket.close()
        self.process.terminate()
        self.process.wait()
        self.profile.cleanup()


class Page(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = serve()
        cls.address = 'http://127.0.0.1:%d/' % cls.server.server_address[1]

    def setUp(self):
        self.page = Browser(self.address)
        self.addCleanup(self.page.close)
        self.page.wait_for(lambda: self.page.value("document.getElementById('run')?.disabled") is False)

    def tearDown(self):
        self.assertEqual(self.page.errors, [])
        self.assertTrue(self.page.value("document.getElementById('notice').hidden"), self.page.text('notice'))

    def choose(self, spacing):
        self.page.value(f"(s => {{ s.value = '{spacing}'; s.dispatchEvent(new Event('change')); }})"
                        "(document.getElementById('spacing'))")
        self.page.wait_for(lambda: self.page.number_in('steps') == 0)

    def test_nothing_passes_and_the_state_is_the_desktops(self):
        page = self.page
        page.click('run')
        page.wait_for_steps(200)
        page.click('run')
        page.wait_for(lambda: page.text('run') == 'Run')
        self.assertEqual(page.number_in('crossings'), 0)
        steps = page.number_in('steps')
        self.assertTrue(page.text('certificate').startswith(f'Certificate: {steps} of {steps} steps'))
        self.assertGreater(page.number_in('pairs'), 1000)
        self.assertRegex(page.text('comparison'), r"^Step \d+: equal to the desktop's$")
        self.assertGreaterEqual(int(page.text('comparison').split()[1].rstrip(':')), 200)
        self.assertRegex(page.text('hash'), '^0x[0-9a-f]{16}$')
        page.picture('contact_on')

    def test_without_contact_it_leaks_with_the_desktops_state(self):
        page = self.page
        self.choose('0.008')
        page.click('contact_text')
        page.click('run')  # the space bar belongs to the switch while it has the focus
        page.wait_for_steps(150)
        page.click('run')
        page.wait_for(lambda: page.text('run') == 'Run')
        self.assertGreater(page.number_in('crossings'), 0)
        self.assertTrue(page.text('certificate').startswith('Certificate: 0 of '))
        self.assertRegex(page.text('comparison'), r"^Step \d+: equal to the desktop's$")
        page.picture('contact_off')

    def test_a_switch_within_a_run_leaks_and_is_not_compared(self):
        page = self.page
        self.choose('0.012')
        page.key(' ')
        page.wait_for_steps(60)
        page.key('c')
        page.wait_for_steps(150)
        page.key(' ')
        self.assertGreater(page.number_in('crossings'), 0)
        self.assertIn('Not compared', page.text('comparison'))
        page.key('r')
        page.wait_for(lambda: page.number_in('steps') == 0)
        self.assertEqual(page.number_in('crossings'), 0)

    def test_pause_freezes_and_step_makes_one_step(self):
        page = self.page
        page.key(' ')
        page.wait_for_steps(20)
        page.key(' ')
        page.wait_for(lambda: page.text('run') == 'Run')
        steps, before = page.number_in('steps'), page.picture()
        time.sleep(1)
        self.assertEqual(page.number_in('steps'), steps)
        self.assertEqual(page.picture(), before)
        page.key('s')
        page.wait_for(lambda: page.number_in('steps') == steps + 1)
        page.click('step')
        page.wait_for(lambda: page.number_in('steps') == steps + 2)
        self.assertNotEqual(page.picture(), before)

    def test_the_mouse_pulls_the_cloth_and_arrows_turn_the_nozzle(self):
        page = self.page
        self.choose('0.012')
        page.key(' ')
        page.wait_for_steps(20)
        x, y = page.centre('view')
        start, end = [x + 0.12 * x, y + 20], [x + 0.12 * x, y - 130]
        page.drag(start, end, hold=3.0)
        for _ in range(6):
            page.call('Input.dispatchKeyEvent', type='keyDown', key='ArrowRight', code='ArrowRight')
            page.call('Input.dispatchKeyEvent', type='keyUp', key='ArrowRight', code='ArrowRight')
        page.wait_for_steps(page.number_in('steps') + 60)
        page.drag(start, end, hold=0.2)  # the cloth is elsewhere by now: the view may turn
        page.key(' ')
        page.wait_for(lambda: page.text('run') == 'Run')
        self.assertIn('Not compared', page.text('comparison'))
        self.assertEqual(page.number_in('crossings'), 0)
        steps = page.number_in('steps')
        self.assertTrue(page.text('certificate').startswith(f'Certificate: {steps} of {steps} steps'))
        page.picture('pulled')

    def test_the_mouse_turns_and_the_wheel_zooms(self):
        page = self.page
        middle = page.centre('view')
        first = page.picture()
        page.drag([60, 60], [260, 120], 'left')
        turned = page.picture()
        self.assertNotEqual(turned, first)
        page.mouse('mouseWheel', middle, deltaX=0, deltaY=-400)
        zoomed = page.picture()
        self.assertNotEqual(zoomed, turned)
        self.assertEqual(page.number_in('steps'), 0)


if __name__ == '__main__':
    unittest.main(argv=sys.argv[:1], verbosity=2)
