/* A controller without a motor on standard input and output: it is where it is told to be at once.
 *
 *     cc -std=c99 -o example example.c motor_line.c
 *     printf '>00 ID*B8EA\n' | ./example
 *
 * What a real one has in its place: a serial port, a ramp generator, an encoder, and a clock for the watchdog.
 */
#include "motor_line.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#define MAX_SPEED 420000u /* hundredths of rpm */
#define MAX_RAMP 420000u  /* hundredths of rpm per second */

static uint32_t speed, watchdog_ms = 2000;
static bool is_on;
static char answer[MOTOR_LINE_LONGEST];

/* The rest of `text` if it begins with `word`, NULL otherwise. */
static const char *after(const char *text, const char *word)
{
    size_t length = strlen(word);
    return strncmp(text, word, length) == 0 ? text + length : NULL;
}

static const char *go(const char *words)
{
    uint32_t wanted, ramp;
    if (!motor_line_number(&words, &wanted) || !motor_line_number(&words, &ramp) || *words)
        return "ERR argument SPEED wants a speed and a ramp";
    if (wanted > MAX_SPEED) {
        snprintf(answer, sizeof answer, "ERR limit speed %" PRIu32 ", at most %" PRIu32, wanted, (uint32_t)MAX_SPEED);
        return answer;
    }
    if (ramp < 1 || ramp > MAX_RAMP)
        return "ERR limit ramp";
    speed = wanted;
    is_on = true;
    return "OK";
}

static const char *obey(const char *request)
{
    const char *words;
    uint32_t wanted;
    if (strcmp(request, "ID") == 0)
        return "OK 1 420000 420000 output RK4 bench controller, rev B";
    if (strcmp(request, "STATE") == 0) {
        uint32_t now = is_on ? speed : 0;
        snprintf(answer, sizeof answer, "OK %" PRIu32 " %" PRIu32 " %s -", now, now, is_on ? "at-speed" : "off");
        return answer;
    }
    if ((words = after(request, "SPEED ")))
        return go(words);
    if (strcmp(request, "STOP RAMP") == 0 || strcmp(request, "STOP COAST") == 0 ||
        strcmp(request, "STOP EMERGENCY") == 0) {
        is_on = false;
        return "OK";
    }
    if (strcmp(request, "CLEAR") == 0)
        return "OK";
    if ((words = after(request, "WATCHDOG ")) && motor_line_number(&words, &wanted) && !*words) {
        watchdog_ms = wanted;
        snprintf(answer, sizeof answer, "OK %" PRIu32, watchdog_ms);
        return answer;
    }
    return "ERR command no such request";
}

int main(void)
{
    static struct motor_line line;
    int byte;

    motor_line_init(&line);
    while ((byte = getchar()) != EOF) {
        switch (motor_line_feed(&line, (char)byte)) {
        case MOTOR_LINE_REQUEST:
            fputs(motor_line_reply(&line, obey(line.text)), stdout);
            break;
        case MOTOR_LINE_RESEND:
            fputs(line.reply, stdout);
            break;
        default:
            break;
        }
        fflush(stdout);
    }
    return 0;
}
