// A texture at pin DAC0 or A0, of a finger whose force is read at A1 and whose speed at A2.
//
// cloth.h is what `htex bake cloth.htex --name texture_cloth -o cloth.h` writes. The samples have 8 kHz: a board that takes more
// than 125 us for one, as those without floating point do, is too slow, which `late` counts.
#include <htex_player.h>

#include "cloth.h"

#if defined(DAC0)
const uint8_t OUTPUT_PIN = DAC0;
#else
const uint8_t OUTPUT_PIN = A0;
#endif
const uint8_t FORCE_PIN = A1;
const uint8_t SPEED_PIN = A2;

// What the sensors read at full scale: replace them by those of your board.
const float MOST_FORCE_N = 1.0f;
const float MOST_SPEED_MM_S = 200.0f;

static HTEX_PLAYER_MEMORY(memory, TEXTURE_CLOTH_NUMBERS);
static htex_player *const player = &memory.player;
static uint32_t period_us;
static uint32_t next_us;
static uint32_t next_reading_us;
static uint32_t late;

void setup() {
  Serial.begin(115200);
  int status = htex_player_open(player, sizeof memory, texture_cloth, sizeof texture_cloth, 1);
  if (status != HTEX_PLAYER_OK) {
    Serial.print("the texture is refused: ");
    Serial.println(status);
    while (true) {
    }
  }
  period_us = (uint32_t)(1e6f / htex_player_rate_hz(player) + 0.5f);
  next_us = micros();
  next_reading_us = next_us;
}

void loop() {
  uint32_t now_us = micros();
  if ((int32_t)(now_us - next_us) < 0) {
    return;
  }
  if ((int32_t)(now_us - next_us) > (int32_t)period_us) {
    late++;
  }
  next_us += period_us;
  // A reading every 10 ms.
  if ((int32_t)(now_us - next_reading_us) >= 0) {
    next_reading_us = now_us + 10000;
    float force_n = MOST_FORCE_N / 1023.0f * (float)analogRead(FORCE_PIN);
    float speed_mm_s = MOST_SPEED_MM_S / 1023.0f * (float)analogRead(SPEED_PIN);
    htex_player_set_motion(player, speed_mm_s, force_n);
  }
  int16_t sample;
  htex_player_render_i16(player, &sample, 1, htex_player_full_scale(player));
  // analogWrite has 8 bits unless it is told otherwise.
  analogWrite(OUTPUT_PIN, (uint8_t)(128 + sample / 256));
}
