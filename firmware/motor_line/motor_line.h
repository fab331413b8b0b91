/* The controller's side of the motor line protocol, version 1 (docs/motor-line.md): lines in, lines out.
 *
 * C99, no allocation, no dependency; about 300 bytes of RAM. Feed it the bytes of the serial port one by one:
 *
 *     switch (motor_line_feed(&line, byte)) {
 *     case MOTOR_LINE_REQUEST: send(motor_line_reply(&line, obey(line.text))); break;
 *     case MOTOR_LINE_RESEND: send(line.reply); break;
 *     default: break;
 *     }
 *
 * Whatever but MOTOR_LINE_NONE it returns has been a request with a good CRC: start the watchdog's time anew.
 * example.c is a whole controller without a motor.
 */
#ifndef MOTOR_LINE_H
#define MOTOR_LINE_H

#include <stdbool.h>
#include <stdint.h>

#define MOTOR_LINE_LONGEST 96 /* bytes of a line, newline included */

enum motor_line_event {
    MOTOR_LINE_NONE,    /* nothing to do: a line has not ended, or was damaged */
    MOTOR_LINE_REQUEST, /* do what `text` asks, then call motor_line_reply */
    MOTOR_LINE_RESEND,  /* a repetition: do nothing, send `reply` again */
    MOTOR_LINE_LATE     /* overtaken by another request: do nothing, send nothing */
};

struct motor_line {
    char text[MOTOR_LINE_LONGEST + 1];  /* of the request: words separated by one space */
    char reply[MOTOR_LINE_LONGEST + 1]; /* the last reply, newline included */
    char late[MOTOR_LINE_LONGEST + 1];  /* the reply to a late STOP, which is not to be repeated */
    uint8_t length;                     /* bytes of the line under way */
    int16_t number;                     /* of the request under way */
    int16_t last;                       /* of the last request taken; -1: nobody has said ID yet */
    bool is_late;
};

/* Begin: after power-up. */
void motor_line_init(struct motor_line *line);

/* Take one byte from the host. */
enum motor_line_event motor_line_feed(struct motor_line *line, char byte);

/* Return the line that answers the request under way with `text`, "OK 2000" or "ERR limit too fast". Text that does not
 * fit is cut; so are bytes a line must not have. */
const char *motor_line_reply(struct motor_line *line, const char *text);

/* Read a number and what separates it from the next word: true if there was one that fits, `*text` behind it. */
bool motor_line_number(const char **text, uint32_t *value);

/* CRC-16/CCITT-FALSE of one more byte; begin with 0xFFFF. */
uint16_t motor_line_crc(uint16_t crc, char byte);

#endif
