// A stub of the Arduino interface, for a test that compiles the sketch on a host, without a board
// or an Arduino core. Its clock advances by 125 us with each call, its inputs read half of their
// range, and it records its output.
#pragma once

#include <cstdint>

const uint8_t A0 = 0;
const uint8_t A1 = 1;
const uint8_t A2 = 2;

struct SerialStub {
  void begin(unsigned long) {}
  void print(const char *) {}
  void println(int status) { refused = status; }
  int refused = 0;
};

extern SerialStub Serial;
uint32_t micros();
int analogRead(uint8_t pin);
void analogWrite(uint8_t pin, int value);
