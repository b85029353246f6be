// Runs the sketch on the stub for one second, and prints what it wrote.
#include <cstdio>

#include "Arduino.h"

SerialStub Serial;

static uint32_t now_us;

uint32_t micros() { return now_us += 125; }

int analogRead(uint8_t) { return 512; }

void analogWrite(uint8_t pin, int value) { std::printf("%d %d\n", pin, value); }

#include "Texture.ino"

int main() {
  setup();
  for (int i = 0; i < 8000 && Serial.refused == 0; i++) {
    loop();
  }
  return Serial.refused == 0 && late == 0 ? 0 : 1;
}
